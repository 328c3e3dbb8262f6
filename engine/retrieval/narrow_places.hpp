#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Up to so many places are all looked at closely; of more, so many (docs/decisions/0015).
inline constexpr std::size_t kAllPlaces = 16;
inline constexpr std::size_t kMostPlaces = 24;

// How well the query lies on the wide grid of each place, before anything finer of it is in memory:
// every pair proposes a pose, all are tested with a few points, the best of each place are settled
// and tested with all points, and the best of these is the place's score, 0..1. Neither counts of
// pairs nor of proposals that agree tell the right place from others. In the order of `matches`.
// The same bytes for any number of threads.
std::vector<double> place_scores(const SearchInput& input, std::span<const EntryMatches> matches);

// The indices of the best `most` of the places, ascending; the first of two that are alike.
std::vector<std::size_t> best_places(std::span<const double> scores, std::size_t most);

}  // namespace landmarkdb
