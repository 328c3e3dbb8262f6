#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace landmarkdb {

// printf into a string. The format is always a literal, the arguments numbers or C strings.
template <typename... Args>
std::string print(const char* format, Args... args) {
  const int length = std::snprintf(nullptr, 0, format, args...);
  std::string out(static_cast<std::size_t>(length > 0 ? length : 0), '\0');
  std::snprintf(out.data(), out.size() + 1, format, args...);
  return out;
}

}  // namespace landmarkdb
