#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "client/answers.hpp"

namespace landmarkdb::client {

// The server's figures and state, for scripts and for people.
nlohmann::ordered_json stats_json(const Stats& stats);
std::string stats_text(const Stats& stats);
nlohmann::ordered_json health_json(const Health& health);
std::string health_text(const Health& health);
nlohmann::ordered_json reload_json(const Reload& reload);
std::string reload_text(const Reload& reload);

}  // namespace landmarkdb::client
