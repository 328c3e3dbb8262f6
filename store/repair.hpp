#pragma once

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"
#include "store/store_types.hpp"

namespace landmarkdb {

// Store::repair. Each kind of repair is a transaction of its own.
RepairReport repair_database(const sqlite::Database& database,
                             const RunContext& context,
                             const ModelDeriver& deriver,
                             const SceneDeriver& scene_deriver);

}  // namespace landmarkdb
