#pragma once

#include <string_view>

namespace landmarkdb {

// Throws Error{kInvalidArgument} unless `name` can name a scene, landmark or tag: 1 to 128
// characters of valid UTF-8, none of them '/' or a control character, no space at either end.
// `what` ("scene name") begins the message.
void validate_name(std::string_view name, std::string_view what);

// The same for a tag's value: up to 1024 characters, '/' and spaces allowed.
void validate_tag_value(std::string_view value);

}  // namespace landmarkdb
