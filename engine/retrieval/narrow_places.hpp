#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Of more than kAllPlaces so many are looked at closely, shared among the levels, and so many of
// each level at least: scores on the grids of different resolutions do not compare
// (docs/decisions/0025).
inline constexpr std::size_t kMostPlaces = 24;
inline constexpr std::size_t kMostPlacesALevel = 4;

struct PlaceScore {
  std::size_t entry = 0;
  double score = 0.0;  // 0..1
};

// How well the query lies on the wide grid of each place of a level that is asked, before anything
// finer of it is in memory: the pairs of a few hundred keypoints propose poses, all are tested with
// a few points, the best of each place are settled and tested with all points, and the best of
// these is the place's score. Neither counts of pairs nor of proposals that agree tell the right
// place from others. In the order of the level's entries. The same bytes for any number of threads.
std::vector<PlaceScore> place_scores(const SearchInput& input,
                                     const Level& level,
                                     const QueryView& view);

// The entries of the best places, ascending: `most` at most, the first of two that are alike, and
// none that is far behind the best. Where a place stands out it is the right one, as a rule; where
// none does they lie close together.
std::vector<std::size_t> best_places(std::span<const PlaceScore> scores, std::size_t most);

}  // namespace landmarkdb
