#pragma once

#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace landmarkdb::client {

// Text as it may stand between tags and within quoted attributes. What is not UTF-8, and control
// characters, become U+FFFD.
std::string html_text(std::string_view text);

// A name from outside: html_text() kept apart from the writing direction around it.
std::string html_name(std::string_view name);

// JSON that may stand in a script element: ASCII alone, and nothing in it that could end the
// element.
std::string json_for_script(const nlohmann::ordered_json& json);

std::string base64(std::string_view bytes);

// The template with each {{name}} replaced, once, by its value; what the values hold is not looked
// at again. Throws Error{kInternal} for a name that has no value.
std::string fill_template(std::string_view text, const std::map<std::string, std::string>& values);

}  // namespace landmarkdb::client
