#pragma once

#include <string>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// The part of Store::check that reads the model tables: digests, indices, BLOB lengths, what is
// derived. Adds to `report`.
void check_models(const sqlite::Database& database, const RunContext& context, CheckReport& report);

// The part of Store::repair: triples, indexes and edge masks made anew, damaged models marked so
// that they are not served. Without `deriver.triples` damaged triples stay, without `deriver.index`
// damaged indexes are dropped.
void repair_models(const sqlite::Database& database,
                   const RunContext& context,
                   const ModelDeriver& deriver,
                   RepairReport& report);

// Makes the search index of each sound model that has none, a damaged one, or one that is not as
// the deriver makes them; says each in a sentence. A transaction a model.
std::vector<std::string> renew_model_indexes(const sqlite::Database& database,
                                             const RunContext& context,
                                             const ModelDeriver& deriver);

}  // namespace landmarkdb
