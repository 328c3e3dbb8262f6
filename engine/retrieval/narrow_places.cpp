#include "engine/retrieval/narrow_places.hpp"

#include <algorithm>
#include <cstdint>

#include "engine/base/parallel.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/settle.hpp"

namespace landmarkdb {

namespace {

// Of 20 frames in 1,000 places of 200,000 points (five levels) the right place is among the four
// best of its level in 12 with 60 neighbours, in 17 with 200, with 400, and with 200 of all
// keypoints, which are twice as many.
constexpr std::size_t kKeypoints = 400;
constexpr std::size_t kNeighbours = 200;
// Proposals settled on the wide grids: shared among the places, and at least so many of each.
constexpr std::size_t kTried = 8'000;
constexpr std::size_t kTriedAtLeast = 16;
// The first test is that of settle_best with fewer points, the last one finer than its grid's cell,
// as the pose has been settled by then.
constexpr std::size_t kFirstPoints = 32;
constexpr ScoreOptions kFirst{.sigma_cells = 1.0F, .first_look = 16, .hopeless = 0.2F};
constexpr std::size_t kLastPoints = 400;
constexpr double kLastSigmaVoxels = 1.2;

// Keypoints of the view, evenly, with what is said of each.
DescriptorSet some_of(const DescriptorSet& all) {
  DescriptorSet some;
  for (const std::uint32_t i : spread(all.size(), kKeypoints)) {
    some.keypoints.push_back(all.keypoints[i]);
    some.frames.push_back(all.frames[i]);
    const std::span<const float> row = all.row(i);
    some.values.insert(some.values.end(), row.begin(), row.end());
  }
  return some;
}

struct Tried {
  float score = 0.0F;
  std::uint32_t proposal = 0;
};

// The `count` best of the proposals by the first test, best first.
std::vector<Tried> best_proposals(const SurfaceGrid& wide,
                                  const TestPoints& test,
                                  std::span<const Proposal> proposals,
                                  std::size_t count) {
  std::vector<Tried> tried(proposals.size());
  for (std::uint32_t i = 0; i < tried.size(); ++i) {
    const Proposal& p = proposals[i];
    tried[i] = {score_pose(wide, test, kFirstPoints, p.R_target_source, p.t_target_source, kFirst),
                i};
  }
  count = std::min(count, tried.size());
  std::partial_sort(tried.begin(),
                    tried.begin() + static_cast<std::ptrdiff_t>(count),
                    tried.end(),
                    [](const Tried& a, const Tried& b) {
                      return a.score != b.score ? a.score > b.score : a.proposal < b.proposal;
                    });
  tried.resize(count);
  return tried;
}

// The keypoints that the pairs name, in the order of the pairs.
DescriptorSet targets_of(const Entry& entry, std::span<const Correspondence> pairs) {
  DescriptorSet targets;
  targets.keypoints.reserve(pairs.size());
  targets.frames.reserve(pairs.size());
  for (const Correspondence& pair : pairs) {
    targets.keypoints.push_back(entry.record().descriptors.keypoints[pair.target]);
    targets.frames.push_back(unpack_rotation(entry.frames[pair.target]));
  }
  return targets;
}

double score_of(const SearchInput& input,
                const Entry& entry,
                const TestPoints& test,
                const DescriptorSet& query,
                std::vector<Correspondence> pairs,
                std::size_t most_tried) {
  const DescriptorSet targets = targets_of(entry, pairs);
  for (std::uint32_t i = 0; i < pairs.size(); ++i) pairs[i].target = i;
  const std::vector<Proposal> proposals =
      propose_from_frames(pairs,
                          targets,
                          query,
                          gravity_of(input.options, entry.record()),
                          prior_of(input, entry.record()));
  const ScoreOptions last{
      .sigma_cells =
          static_cast<float>(kLastSigmaVoxels * entry.grid.cell_m()) / entry.wide.cell_m(),
      .first_look = kLastPoints,
      .hopeless = 0.0F};
  float best = 0.0F;
  for (const Tried& tried : best_proposals(entry.wide, test, proposals, most_tried)) {
    if (tried.score <= 0.0F) break;
    Proposal p = proposals[tried.proposal];
    settle_pose(entry.wide, test, {}, p.R_target_source, p.t_target_source);
    const float score =
        score_pose(entry.wide, test, kLastPoints, p.R_target_source, p.t_target_source, last);
    best = std::max(best, score);
  }
  return static_cast<double>(best);
}

}  // namespace

std::vector<PlaceScore> place_scores(const SearchInput& input,
                                     const Level& level,
                                     const QueryView& view) {
  const DescriptorSet query = some_of(view.descriptors);
  std::vector<std::size_t> parts;  // the wanted ones among the level's entries
  for (std::size_t i = 0; i < level.entries.size(); ++i) {
    if (input.wanted[level.entries[i]]) parts.push_back(i);
  }
  std::vector<std::vector<Correspondence>> pairs;
  {
    const StageTimer timer(input.timings.match);
    std::vector<DescriptorMatch> found;
    if (parts.size() == level.entries.size()) {
      level.index->search(query.values, kNeighbours, found, input.context);
    } else {
      level.index->search_parts(parts, query.values, kNeighbours, found, input.context);
    }
    pairs = sort_out_matches(level, found, kNeighbours);
  }
  const StageTimer timer(input.timings.pose);
  std::size_t places = 0;
  for (const Level& one : input.levels) places += one.entries.size();
  const std::size_t most_tried = std::max(kTriedAtLeast, kTried / places);
  std::vector<PlaceScore> scores(parts.size());
  parallel_each(scores.size(), input.context.threads, [&](std::size_t i) {
    input.context.check("pose");
    std::vector<Correspondence>& own = pairs[parts[i]];
    scores[i].entry = level.entries[parts[i]];
    if (own.empty()) return;
    const Entry& entry = input.entries[scores[i].entry];
    scores[i].score = score_of(input, entry, view.test, query, std::move(own), most_tried);
  });
  set_standings(scores);
  return scores;
}

void set_standings(std::span<PlaceScore> of_level) {
  if (of_level.empty()) return;
  std::vector<double> sorted;
  for (const PlaceScore& one : of_level) sorted.push_back(one.score);
  const auto low = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 4);
  std::nth_element(sorted.begin(), low, sorted.end());
  constexpr double kLeastLeft = 1e-3;
  const double left = std::max(1.0 - *low, kLeastLeft);
  for (PlaceScore& one : of_level) one.standing = (one.score - *low) / left;
}

std::vector<std::size_t> best_places(std::span<const PlaceScore> scores, std::size_t most) {
  std::vector<PlaceScore> order(scores.begin(), scores.end());
  std::stable_sort(order.begin(), order.end(), [](const PlaceScore& a, const PlaceScore& b) {
    return a.standing > b.standing;
  });
  if (order.size() > most) order.resize(most);
  // Of 40 frames in a hundred places and 40 in a thousand the right one is in 68 among the ten that
  // stand highest, and never with less than 0.73 of the highest; five places have more than 0.6 of
  // it in the mean.
  constexpr double kLeastOfBest = 0.6;
  std::vector<std::size_t> best;
  for (const PlaceScore& one : order) {
    if (one.standing >= kLeastOfBest * order.front().standing) best.push_back(one.entry);
  }
  std::sort(best.begin(), best.end());
  return best;
}

}  // namespace landmarkdb
