#include "indexer/checked_names.hpp"

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"
#include "store/names.hpp"

namespace landmarkdb::indexer {

void require_name(const std::string& name, const std::string& what, const std::string& argument) {
  try {
    validate_name(name, what);
  } catch (const Error& error) {
    throw cli::UsageError(argument, error.what());
  }
}

void require_tag_value(const std::string& value, const std::string& argument) {
  try {
    validate_tag_value(value);
  } catch (const Error& error) {
    throw cli::UsageError(argument, error.what());
  }
}

}  // namespace landmarkdb::indexer
