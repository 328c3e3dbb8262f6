#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "engine/servo/servo.hpp"

namespace landmarkdb {

// What stands in the file of `track --servo`: docs/servoing.md explains every key.
struct ServoFile {
  std::string name{};
  ServoOptions options{};
  bool symmetry_given = false;     // false: the model's own may be taken
  std::optional<JointVector> q{};  // the joints at the first frame
};

// Reads such a file from memory; `name` is what messages call it.
//
// Throws Error{kInvalidArgument} that names the file, the key, what was seen and what was wanted.
// A key it does not know is refused too: a misspelt limit must not count as none.
ServoFile parse_servo(const std::string& text, std::string_view name);

ServoFile read_servo(const std::filesystem::path& path);

}  // namespace landmarkdb
