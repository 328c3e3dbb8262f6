#pragma once

#include <cstdint>
#include <string>

namespace landmarkdb {

// Memory this process holds in RAM, from /proc; 0 where that cannot be read.
std::uint64_t resident_bytes();

// The size of a file; 0 where there is none.
std::uint64_t file_bytes(const std::string& path);

}  // namespace landmarkdb
