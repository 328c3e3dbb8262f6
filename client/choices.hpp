#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/types/features.hpp"
#include "engine/types/query.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::client {

// The words that options take one of, for the option tables, and what each means. The functions
// throw cli::UsageError naming `option` for a word that is none of them.

inline const std::vector<std::string> kUnitNames = {"m", "mm", "cm", "inch"};
inline const std::vector<std::string> kProfileNames = {"robust", "paper"};
inline const std::vector<std::string> kSearchNames = {"exact", "flann"};
inline const std::vector<std::string> kSolverNames = {"similarity", "pnp"};
inline const std::vector<std::string> kKindNames = {"place", "object"};
inline const std::vector<std::string> kKeypointNames = {"uniform", "structure", "iss", "narf"};
inline const std::vector<std::string> kMeasureNames = {
    "l2", "l1", "chi2", "intersection", "correlation", "bhattacharyya"};
inline const std::vector<std::string> kFilterNames = {"ratio", "slope", "clique"};

KeypointMethod keypoint_method(std::string_view word, const std::string& option);
Measure measure(std::string_view word, const std::string& option);
// "ratio,slope,clique": a list of filters, in the order given; a filter named twice is refused.
std::vector<Filter> filters(std::string_view list, const std::string& option);

std::string_view name_of(KeypointMethod method);
std::string_view name_of(EntryKind kind);

}  // namespace landmarkdb::client
