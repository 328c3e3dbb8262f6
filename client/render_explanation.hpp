#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "engine/types/explanation.hpp"

namespace landmarkdb::client {

// The object `explain` of `query --explain --json`.
nlohmann::ordered_json explanation_json(const Explanation& explanation);

// The same for people, as the lines after those of query_text().
std::string explanation_text(const Explanation& explanation);

// "pairs of like descriptors" for "putative"; the name itself for a step this client does not know.
std::string step_meaning(const std::string& name);

// "best", "rival" or "behind".
std::string_view role_name(CandidateRole role);

// "--min-confidence 0.41 would have accepted it". May hold a scene's name as it is.
std::string remedy_sentence(const Remedy& remedy);

// The figures of a candidate with what each gave to its confidence and cost it, in log-odds.
struct ForAndAgainst {
  std::string spoke_for;
  std::string spoke_against;
};
ForAndAgainst weigh(const ExplainedCandidate& candidate);

}  // namespace landmarkdb::client
