#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "engine/retrieval/search.hpp"

namespace landmarkdb {

// Of more than kAllPlaces so many at most are looked at closely (docs/decisions/0027).
inline constexpr std::size_t kMostPlaces = 10;
// A level of so few places is looked at whole: they do not tell what a wrong place's score is.
inline constexpr std::size_t kFewOfLevel = 4;

struct PlaceScore {
  std::size_t entry = 0;
  double score = 0.0;     // 0..1
  double standing = 0.0;  // how far it stands out among the level's places: at most 1
};

// How well the query lies on the wide grid of each place of a level that is asked, before anything
// finer of it is in memory: the pairs of a few hundred keypoints propose poses, all are tested with
// a few points, the best of each place are settled and tested with all points, and the best of
// these is the place's score. Neither counts of pairs nor of proposals that agree tell the right
// place from others. In the order of the level's entries, with their standing. The same bytes for
// any number of threads.
std::vector<PlaceScore> place_scores(const SearchInput& input,
                                     const Level& level,
                                     const QueryView& view);

// Scores on the grids of different resolutions do not compare: on large cells a frame lies well
// anywhere. So a place stands as high as its share of what the lower quartile of its level leaves
// unexplained. That is of wrong places even where half of them look like the right one.
void set_standings(std::span<PlaceScore> of_level);

// The entries of the places, of one level or several, that stand highest, ascending: `most` at
// most, the first of two that are alike, and none that is far behind the best. Where a place stands
// out it is the right one, as a rule; where none does they lie close together.
std::vector<std::size_t> best_places(std::span<const PlaceScore> scores, std::size_t most);

}  // namespace landmarkdb
