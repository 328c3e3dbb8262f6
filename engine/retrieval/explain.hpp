#pragma once

#include <span>
#include <string>

#include "engine/retrieval/search.hpp"
#include "engine/retrieval/verdict.hpp"
#include "engine/types/explanation.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// An answered query, as it is to be explained.
struct Decision {
  const SearchInput& input;
  const SearchResult& search;         // its poses are those the verdict was made from
  std::span<const Assessed> dropped;  // verified poses that contradicted --up or --prior
  const Verdict& verdict;
  const VerdictOptions& options;
  const QueryResult& answer;  // status, reason and counts
};

// What the search counted, the places it weighed, the stage that lost the query and what would have
// changed that. Decides again with other parameters, on the poses that the search had verified;
// searches nothing again.
Explanation explain(const Decision& decision);

// Of a query that never came to be searched for: its counts, and the stage its reason names.
Explanation explain_unsearched(const QueryResult& answer);

// What cost a pose its confidence, costliest first.
std::vector<ConfidenceTerm> confidence_terms(const Evidence& evidence,
                                             double quality,
                                             double margin);

// The parameters that would have changed the answer, nearest first.
std::vector<Remedy> find_remedies(const Decision& decision);

}  // namespace landmarkdb
