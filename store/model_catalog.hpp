#pragma once

#include <memory>

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// Store::load_models.
std::shared_ptr<const MonoCatalog> load_mono_catalog(const sqlite::Database& database,
                                                     const RunContext& context,
                                                     const OnDamagedModel& on_damaged,
                                                     const MonoCatalog* previous);

}  // namespace landmarkdb
