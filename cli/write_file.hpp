#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace landmarkdb::cli {

// Puts `bytes` into the file that `option` names. A regular file appears whole or is left as it
// was: the bytes are written beside it and renamed. What is no regular file (a device, a pipe, a
// link such as /dev/stdout) is written as it is. Throws Error{kResourceExhausted} that names the
// file and `option`.
void write_file(const std::filesystem::path& path,
                std::string_view bytes,
                const std::string& option);

}  // namespace landmarkdb::cli
