#include "server/model_admin.hpp"

#include <span>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/search_tables.hpp"
#include "server/change_database.hpp"
#include "server/convert_recognition.hpp"
#include "store/names.hpp"
#include "store/store.hpp"

namespace landmarkdb {
namespace {

std::string quarantine_reason(const Served* served, const ModelSummary& model) {
  if (served == nullptr) return {};
  for (const DamagedModel& damaged : served->damaged_models) {
    if (damaged.model_id == model.id) return damaged.what;
  }
  return {};
}

std::optional<Units> units_from(const std::string& text) {
  if (text.empty()) return std::nullopt;
  if (text == "m") return Units::kMetres;
  if (text == "mm") return Units::kMillimetres;
  if (text == "cm") return Units::kCentimetres;
  if (text == "inch") return Units::kInches;
  throw Error(ErrorCode::kInvalidArgument,
              "units: want \"m\", \"mm\", \"cm\", \"inch\" or nothing",
              "units");
}

}  // namespace

v1::ModelInfo ModelAdmin::info(const Store& store, const std::string& name) const {
  const ModelSummary summary = store.show_model(name);
  return to_proto(summary, quarantine_reason(state_.served_or_null().get(), summary));
}

v1::ModelListReply ModelAdmin::list() const {
  const std::shared_ptr<const Served> served = state_.served_or_null();
  const Store store = Store::open_read_only(state_.db_path());
  v1::ModelListReply reply;
  for (const ModelSummary& model : store.list_models()) {
    *reply.add_models() = to_proto(model, quarantine_reason(served.get(), model));
  }
  reply.set_generation(store.generation());
  return reply;
}

v1::ModelReply ModelAdmin::show(const std::string& name) const {
  const Store store = Store::open_read_only(state_.db_path());
  v1::ModelReply reply;
  *reply.mutable_model() = info(store, name);
  reply.set_json(model_to_json(store.load_model(name)->model));
  return reply;
}

v1::ModelReply ModelAdmin::add(const v1::ModelAddRequest& request,
                               const RunContext& context) const {
  Store store = open_for_change(options_, state_);
  validate_name(request.name(), "model name");
  const std::string file_name = request.file_name().empty() ? request.name() : request.file_name();
  ReadModelResult read = parse_model(std::as_bytes(std::span(request.file())),
                                     file_name,
                                     {.units = units_from(request.units())},
                                     context);
  read.model.name = request.name();
  const MonoModelRecord record = derive_record(std::move(read.model), context);
  const InsertModelResult stored = store.insert_model(record, read.warnings, context);
  put_in_service(options_, state_);
  v1::ModelReply reply;
  *reply.mutable_model() = info(store, request.name());
  reply.set_replaced(stored.replaced);
  return reply;
}

v1::ModelRemoveReply ModelAdmin::remove(const v1::ModelRemoveRequest& request) const {
  open_for_change(options_, state_).remove_model(request.name());
  put_in_service(options_, state_);
  return {};
}

v1::ModelReply ModelAdmin::rename(const v1::ModelRenameRequest& request) const {
  open_for_change(options_, state_).rename_model(request.old_name(), request.new_name());
  put_in_service(options_, state_);
  return show(request.new_name());
}

}  // namespace landmarkdb
