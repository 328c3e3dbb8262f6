#pragma once

#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/mono/read_model.hpp"
#include "store/model_types.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {

struct AddModelRequest {
  std::string name;  // to store it under; empty: what the file says
  std::string file;
  ReadModelOptions options{};
};

struct AddModelResult {
  InsertModelResult stored;
  ModelSummary summary;  // as stored
};

// Reads a model, makes its triples and stores both. The database is opened for writing only at the
// end, and made where there is none; whatever goes wrong before leaves it as it was.
AddModelResult add_model(const AddModelRequest& request,
                         const std::string& db,
                         const RunContext& context);

// Writes a stored model as a model file (JSON, metres, all that is derived listed); `import` or
// `model add` read it back to the same model. Error{kAlreadyExists} when there is a file at `path`.
void export_model(const Store& store, const std::string& name, const std::string& path);

}  // namespace landmarkdb::indexer
