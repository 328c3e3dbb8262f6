#include "indexer/add_model.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/mono/search_tables.hpp"
#include "indexer/new_database.hpp"
#include "store/names.hpp"
#include "store/output_file.hpp"

namespace landmarkdb::indexer {

AddModelResult add_model(const AddModelRequest& request,
                         const std::string& db,
                         const RunContext& context) {
  require_writable_database(db);
  ReadModelResult read = read_model(request.file, request.options, context);
  if (!request.name.empty()) read.model.name = request.name;
  validate_name(read.model.name, "model name");
  const MonoModelRecord record = derive_record(std::move(read.model), context);
  AddModelResult result;
  change_or_create(db, [&](Store& store) {
    result.stored = store.insert_model(record, read.warnings, context);
    result.summary = store.show_model(record.model.name);
    return InsertResult{};
  });
  return result;
}

void export_model(const Store& store, const std::string& name, const std::string& path) {
  const std::string json = model_to_json(store.load_model(name)->model) + "\n";
  write_new_file(path, [&](const std::string& temporary) {
    std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
    stream.write(json.data(), static_cast<std::streamsize>(json.size()));
    stream.close();
    if (!stream) {
      throw Error(errno == ENOSPC ? ErrorCode::kResourceExhausted : ErrorCode::kPermissionDenied,
                  "'" + path + "' cannot be written: " + std::strerror(errno));
    }
  });
}

}  // namespace landmarkdb::indexer
