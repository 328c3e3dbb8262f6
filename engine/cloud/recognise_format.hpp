#pragma once

#include <optional>
#include <string_view>

#include "engine/cloud/input.hpp"

namespace landmarkdb {

enum class CloudFormat { kPly, kPcd, kText, kObj, kBinaryStl, kAsciiStl };

// What kind of file this is, by its content; the name's extension helps where that leaves a doubt.
// Throws Error{kInvalidArgument} for anything else; a format that is known but not read (LAS, E57
// and others) is named, with what to do about it.
CloudFormat recognise_format(const Input& input);

}  // namespace landmarkdb
