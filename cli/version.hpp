#pragma once

#include <string>
#include <string_view>

namespace landmarkdb::cli {

// The contracts a build speaks. A test holds them against the store's and the protocol's own.
inline constexpr int kDatabaseVersion = 4;
inline constexpr int kProtocolVersion = 1;

// "0.1.0"
std::string_view program_version();

// "landmarkdb 0.1.0 (database version 1, protocol version 1)"
std::string version_text(std::string_view program);

}  // namespace landmarkdb::cli
