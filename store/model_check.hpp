#pragma once

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// The part of Store::check that reads the model tables: digests, indices, BLOB lengths, what is
// derived. Adds to `report`.
void check_models(const sqlite::Database& database, const RunContext& context, CheckReport& report);

// The part of Store::repair: triples and edge masks made anew, damaged indexes dropped, damaged
// models marked so that they are not served. Without `make_triples` damaged triples stay.
void repair_models(const sqlite::Database& database,
                   const RunContext& context,
                   const MakeTriples& make_triples,
                   RepairReport& report);

}  // namespace landmarkdb
