#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/registration/propose.hpp"
#include "engine/registration/propose_from_planes.hpp"
#include "engine/retrieval/narrow_places.hpp"
#include "engine/retrieval/rank_poses.hpp"
#include "engine/retrieval/search.hpp"

namespace landmarkdb {

namespace {

// In the lobby of the bench 10, 30 and 60 neighbours put the right pose among the proposals of 15,
// 19 and 19 of 20 frames and first in 12, 15 and 18; 100 add nothing. A proposal costs a
// microsecond, and what verification is shown right it ranks right. With more places searched at
// once the right one must still be among them, so their number grows with the places, up to a
// bound.
constexpr std::size_t kNeighbours = 60;
constexpr std::size_t kNeighboursAPlace = 20;
constexpr std::size_t kMostNeighbours = 200;

// A frame of bare walls has a few dozen keypoints: each then gets more neighbours, up to as many
// proposals as a cluttered one makes in each place, or, of places that were found likely, in one.
constexpr std::size_t kProposalsAPlace = 50'000;
constexpr std::size_t kMostNeighboursOfFew = 400;

std::size_t neighbours_for(std::size_t places, bool narrowed, std::size_t keypoints) {
  const std::size_t usual =
      std::min(kMostNeighbours, kNeighbours + kNeighboursAPlace * (places - 1));
  const std::size_t affordable =
      (narrowed ? 1 : places) * kProposalsAPlace / std::max<std::size_t>(keypoints, 1);
  return std::clamp(affordable, usual, kMostNeighboursOfFew);
}

// The proposals to be settled are shared among the places.
constexpr std::size_t kSettled = 6000;
constexpr std::size_t kSettledAPlace = 1500;
constexpr std::size_t kSettledAtLeast = 300;

// A query thinner than this has too few points in a descriptor's support to look like a place's
// surface. A turn of a 16-line laser indoors is three to six voxels of 5 cm apart, and its
// keypoints on what is near still find the place: with this at 2.5 half of those turns were
// refused, at 8 nine in ten are localized, none wrongly.
constexpr double kMostSpacingVoxelsOfPlace = 8.0;

// A query of fewer voxels than this is too small a thing to be told apart at the entry's
// resolution.
constexpr std::size_t kFewestVoxels = 150;

// The levels' own indexes are of codes, by l2; another is made when it is asked for.
bool is_by_codes(const QueryOptions& options) {
  return options.measure == Measure::kL2 && options.search == Search::kExact;
}

// Some places of a level, to be searched as if there were no others.
struct AskedPlaces {
  const Level& level;
  const QueryView& view;             // the query as these places are described
  std::vector<std::size_t> entries;  // ascending
  bool narrowed = false;             // they are what seemed likely
  bool in_index = true;              // the level's index will do

  bool are_all() const { return entries.size() == level.entries.size(); }
  // Their numbers among the level's entries.
  std::vector<std::size_t> parts() const {
    std::vector<std::size_t> parts;
    for (std::size_t i = 0; i < level.entries.size(); ++i) {
      if (std::binary_search(entries.begin(), entries.end(), level.entries[i])) parts.push_back(i);
    }
    return parts;
  }
};

// The k nearest stored descriptors of each of the query's, sorted out by entry.
void match_places_of(const SearchInput& input, const AskedPlaces& asked, SearchResult& result) {
  const StageTimer timer(input.timings.match);
  const QueryView& view = asked.view;
  const std::size_t k =
      neighbours_for(asked.entries.size(), asked.narrowed, view.descriptors.size());
  const std::vector<float>& queries = view.descriptors.values;
  const bool by_codes = is_by_codes(input.options);
  std::optional<Level> own;
  if (!asked.are_all() && !(asked.in_index && by_codes)) {
    own = make_level(input.entries, asked.entries, input.context);
  }
  const Level& level = own ? *own : asked.level;
  std::vector<DescriptorMatch> found;
  if (!by_codes) {
    index_over(input, level)->search(queries, k, found, input.context);
  } else if (own || asked.are_all()) {
    level.index->search(queries, k, found, input.context);
  } else {
    level.index->search_parts(asked.parts(), queries, k, found, input.context);
  }
  std::vector<std::vector<Correspondence>> pairs = sort_out_matches(level, found, k);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i].empty() || !input.wanted[level.entries[i]]) continue;
    EntryMatches matches;
    matches.entry = level.entries[i];
    matches.view = &view;
    matches.counts.putative = static_cast<std::uint32_t>(pairs[i].size());
    matches.putative = std::move(pairs[i]);
    result.matches.push_back(std::move(matches));
  }
}

std::size_t wanted_places(const SearchInput& input) {
  std::size_t count = 0;
  for (const Level& level : input.levels) {
    count += static_cast<std::size_t>(
        std::count_if(level.entries.begin(), level.entries.end(), [&](std::size_t e) {
          return input.wanted[e];
        }));
  }
  return count;
}

// The wanted places, level by level, of those levels that the query can be described for.
std::vector<AskedPlaces> asked_places(const SearchInput& input, SearchResult& result) {
  std::vector<AskedPlaces> all;
  for (const Level& level : input.levels) {
    std::vector<std::size_t> entries;
    std::copy_if(level.entries.begin(),
                 level.entries.end(),
                 std::back_inserter(entries),
                 [&](std::size_t entry) { return input.wanted[entry]; });
    if (entries.empty()) continue;
    if (input.query.scale.spacing_m > kMostSpacingVoxelsOfPlace * level.options.voxel_m) {
      result.lost_at = "density";
      result.needs_voxel_m = input.query.scale.spacing_m / kMostSpacingVoxelsOfPlace;
      continue;
    }
    const QueryView& view = input.views.at(query_features(level.options, input.options));
    if (view.prepared.size() < kFewestVoxels || view.descriptors.size() == 0) continue;
    all.push_back({level, view, std::move(entries)});
  }
  return all;
}

// Leaves the places that seem likely, whatever level they are of; of some levels none.
void narrow_down(const SearchInput& input, std::vector<AskedPlaces>& asked) {
  std::vector<PlaceScore> scores;
  for (AskedPlaces& places : asked) {
    if (places.entries.size() <= kFewOfLevel) continue;
    places.narrowed = true;
    const std::vector<PlaceScore> of_level = place_scores(input, places.level, places.view);
    scores.insert(scores.end(), of_level.begin(), of_level.end());
  }
  const std::vector<std::size_t> best = best_places(scores, kMostPlaces);
  for (AskedPlaces& places : asked) {
    if (!places.narrowed) continue;
    std::erase_if(places.entries, [&](std::size_t entry) {
      return !std::binary_search(best.begin(), best.end(), entry);
    });
  }
}

// Planes propose as many poses of a place as all its pairs do: they are tried in those places that
// most of the query's keypoints have neighbours in.
void choose_for_planes(std::vector<EntryMatches>& matches) {
  constexpr std::size_t kMostLaid = 4;
  std::vector<EntryMatches*> order;
  for (EntryMatches& one : matches) order.push_back(&one);
  std::stable_sort(order.begin(), order.end(), [](const EntryMatches* a, const EntryMatches* b) {
    return a->putative.size() > b->putative.size();
  });
  order.resize(std::min(order.size(), kMostLaid));
  for (EntryMatches* one : order) one->by_planes = true;
}

// Brings the places into memory.
void load_places(const SearchInput& input, SearchResult& result) {
  const StageTimer timer(input.timings.load);
  std::vector<std::size_t> which;
  for (const EntryMatches& one : result.matches) which.push_back(one.entry);
  input.entries.load(which, SceneParts::kSurface, input.context);
  std::erase_if(result.matches,
                [&](const EntryMatches& one) { return input.entries.is_damaged(one.entry); });
}

void propose_and_rank(const SearchInput& input,
                      std::size_t m,
                      std::size_t settled_each,
                      SearchResult& result,
                      std::vector<Candidate>& candidates) {
  const StageTimer timer(input.timings.pose);
  const EntryMatches& matches = result.matches[m];
  const Entry& entry = input.entries[matches.entry];
  const std::vector<Proposal> proposals = propose(input, matches);
  const std::vector<Proposal> settled = settle_best(entry.wide,
                                                    entry.grid,
                                                    matches.view->test,
                                                    proposals,
                                                    input.query.centre,
                                                    {.kept = settled_each},
                                                    input.context);
  const std::vector<RankedPose> survivors = rank_poses(entry.grid,
                                                       matches.view->test,
                                                       settled,
                                                       input.query.centre,
                                                       {.scanned = &entry.scanned},
                                                       input.context);
  for (const RankedPose& ranked : survivors) {
    candidates.push_back({m, ranked.T_target_source, ranked.score, ranked.correspondence});
  }
  result.matches[m].poses.proposals = proposals.size();
  result.matches[m].poses.survivors = survivors.size();
}

}  // namespace

std::vector<Proposal> propose(const SearchInput& input, const EntryMatches& matches) {
  const Entry& entry = input.entries[matches.entry];
  const std::optional<Gravity> gravity = gravity_of(input.options, entry.record());
  const std::optional<PositionPrior> prior = prior_of(input, entry.record());
  std::vector<Proposal> proposals = propose_from_frames(
      matches.putative, entry.record().descriptors, matches.view->descriptors, gravity, prior);
  if (!matches.by_planes) return proposals;
  for (const PlaneLayout& of_entry : entry.planes.get()) {
    for (const PlaneLayout& of_query : matches.view->planes) {
      const std::vector<Proposal> more =
          propose_from_planes(of_entry, of_query, input.query.centre.cast<float>(), gravity, prior);
      proposals.insert(proposals.end(), more.begin(), more.end());
    }
  }
  return proposals;
}

double common_tolerance_m(const SearchInput& input, const Entry& entry) {
  constexpr double kCells = 0.75;
  constexpr double kLeastCells = 0.4;
  double finest_m = entry.grid.cell_m();
  for (const Level& level : input.levels) {
    const bool asked = std::any_of(
        level.entries.begin(), level.entries.end(), [&](std::size_t e) { return input.wanted[e]; });
    if (asked) finest_m = std::min(finest_m, level.options.voxel_m);
  }
  return std::max(kCells * finest_m, kLeastCells * entry.grid.cell_m());
}

void match_places(const SearchInput& input, SearchResult& result) {
  std::vector<AskedPlaces> asked = asked_places(input, result);
  if (wanted_places(input) > kAllPlaces) narrow_down(input, asked);
  for (AskedPlaces& places : asked) {
    if (places.entries.empty()) continue;
    if (!places.narrowed && !input.options.scenes.empty()) {
      // What is asked of named scenes must not depend on the others, so that it is not left to
      // codes without tails.
      places.in_index = places.level.index->has_tails() &&
                        rows_of(input.entries, places.entries) <= kMostScannedRows;
    }
    match_places_of(input, places, result);
  }
}

void search_places(const SearchInput& input, SearchResult& result) {
  std::vector<Candidate> candidates;
  match_places(input, result);
  load_places(input, result);
  choose_for_planes(result.matches);
  const std::size_t places = std::max<std::size_t>(result.matches.size(), 1);
  const std::size_t settled_each = std::clamp(kSettled / places, kSettledAtLeast, kSettledAPlace);
  for (std::size_t m = 0; m < result.matches.size(); ++m) {
    propose_and_rank(input, m, settled_each, result, candidates);
  }
  if (candidates.empty()) {
    if (result.lost_at.empty()) result.lost_at = result.matches.empty() ? "keypoints" : "pose";
    return;
  }
  assess_candidates(
      input,
      std::move(candidates),
      [&](const EntryMatches& matches) {
        return Meeting{.target = input.entries[matches.entry].grid,
                       .source = matches.view->sample_points,
                       .source_normals = matches.view->sample_normals,
                       .tolerance_m = common_tolerance_m(input, input.entries[matches.entry]),
                       .precise = matches.view->precise_points,
                       .precise_normals = matches.view->precise_normals};
      },
      result);
}

}  // namespace landmarkdb
