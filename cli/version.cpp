#include "cli/version.hpp"

namespace landmarkdb::cli {

std::string_view program_version() { return LANDMARKDB_VERSION; }

std::string version_text(std::string_view program) {
  return std::string(program) + ' ' + std::string(program_version()) + " (database version " +
         std::to_string(kDatabaseVersion) + ", protocol version " +
         std::to_string(kProtocolVersion) + ')';
}

}  // namespace landmarkdb::cli
