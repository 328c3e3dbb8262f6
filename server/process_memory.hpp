#pragma once

#include <cstdint>
#include <string>

namespace landmarkdb {

// Memory this process holds in RAM, from /proc; 0 where that cannot be read.
std::uint64_t resident_bytes();

// Gives pages back that hold nothing: building a catalogue frees much between what stays.
void release_free_memory();

// The size of a file; 0 where there is none.
std::uint64_t file_bytes(const std::string& path);

}  // namespace landmarkdb
