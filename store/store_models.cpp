#include "store/model_catalog.hpp"
#include "store/model_changes.hpp"
#include "store/model_rows.hpp"
#include "store/store.hpp"
#include "store/store_state.hpp"

namespace landmarkdb {

using sqlite::Transaction;

std::vector<ModelSummary> Store::list_models() const {
  const Transaction snapshot = state_->snapshot();
  std::vector<ModelSummary> models;
  sqlite::Statement rows(state_->reader(), "SELECT id FROM mono_model ORDER BY name");
  while (rows.step()) models.push_back(read_model_summary(state_->reader(), rows.integer(0)));
  return models;
}

ModelSummary Store::show_model(std::string_view name) const {
  const Transaction snapshot = state_->snapshot();
  return read_model_summary(state_->reader(), require_model_row(state_->reader(), name).id);
}

std::shared_ptr<const MonoModelRecord> Store::load_model(std::string_view name) const {
  const Transaction snapshot = state_->snapshot();
  return read_model_record(state_->reader(), require_model_row(state_->reader(), name));
}

std::shared_ptr<const MonoCatalog> Store::load_models(const RunContext& context,
                                                      const OnDamagedModel& on_damaged,
                                                      const MonoCatalog* previous) const {
  return load_mono_catalog(state_->reader(), context, on_damaged, previous);
}

InsertModelResult Store::insert_model(const MonoModelRecord& record,
                                      const std::vector<std::string>& warnings,
                                      const RunContext& context) {
  return landmarkdb::insert_model(state_->writer(), record, warnings, context);
}

void Store::remove_model(std::string_view name) {
  landmarkdb::remove_model(state_->writer(), name);
}

void Store::rename_model(std::string_view old_name, std::string_view new_name) {
  landmarkdb::rename_model(state_->writer(), old_name, new_name);
}

}  // namespace landmarkdb
