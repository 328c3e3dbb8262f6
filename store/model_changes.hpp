#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/run_context.hpp"
#include "store/model_types.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// Changes of the model tables, each in a transaction of its own that also raises the generation.

// Stores a model; one of that name is replaced in the same transaction, under a new id.
InsertModelResult insert_model(const sqlite::Database& database,
                               const MonoModelRecord& record,
                               const std::vector<std::string>& warnings,
                               const RunContext& context);
void remove_model(const sqlite::Database& database, std::string_view name);
void rename_model(const sqlite::Database& database,
                  std::string_view old_name,
                  std::string_view new_name);

}  // namespace landmarkdb
