#pragma once

#include <span>
#include <string>
#include <string_view>

#include "engine/types/query.hpp"

namespace landmarkdb::client {

// The answer in a few lines for people: verdict, place, pose (metres; roll, pitch, yaw in degrees),
// chain, counts, fit, timings, warnings. All poses when ambiguous; the reason and a hint when not
// found; the explanation, where there is one. Ends with a newline.
std::string query_text(const QueryResult& result);

// What an ambiguous answer says of its poses, without a full stop.
std::string ambiguity_text(std::span<const Hypothesis> hypotheses);

// What a warning of the answer means to the person who asked; empty for one it does not know.
std::string_view warning_meaning(std::string_view warning);

}  // namespace landmarkdb::client
