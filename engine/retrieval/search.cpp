#include "engine/retrieval/search.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/retrieval/rank_poses.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kCoarse = 60;  // candidates of all entries together that are refined at all
constexpr std::size_t kFine = 12;    // those refined with every point, and judged

std::vector<Assessed> assess_all_coarse(const SearchInput& input,
                                        std::span<const Candidate> candidates,
                                        const MeetingOf& meeting_of,
                                        const SearchResult& result) {
  std::vector<Assessed> assessed(candidates.size());
  parallel_chunks(
      candidates.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          input.context.check("icp");
          const EntryMatches& matches = result.matches[candidates[i].matches];
          assessed[i] = assess_coarse(meeting_of(matches), candidates[i].T_entry_sensor);
          assessed[i].entry = matches.entry;
          assessed[i].matches = candidates[i].matches;
          assessed[i].correspondence = candidates[i].correspondence;
        }
      });
  std::stable_sort(assessed.begin(), assessed.end(), [](const Assessed& a, const Assessed& b) {
    return a.score > b.score;
  });
  return assessed;
}

// The best poses that refinement has not carried to the same place, and at least one of every entry
// whose best comes close, so that look-alike places are compared with care.
std::vector<Assessed> best_distinct(const std::vector<Assessed>& assessed,
                                    std::span<const Entry> entries,
                                    const Eigen::Vector3d& centre) {
  std::vector<Assessed> kept;
  for (const Assessed& candidate : assessed) {
    if (kept.size() >= kFine) break;
    const double cell_m = entries[candidate.entry].grid.cell_m();
    constexpr double kSameCells = 2.0;
    constexpr double kSameRad = 0.05;
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Assessed& other) {
      return other.entry == candidate.entry && same_pose(candidate.T_entry_sensor,
                                                         other.T_entry_sensor,
                                                         centre,
                                                         kSameCells * cell_m,
                                                         kSameRad);
    });
    if (!known) kept.push_back(candidate);
  }
  return kept;
}

}  // namespace

const QueryView& ViewCache::at(const FeatureOptions& options) {
  for (const Made& made : made_) {
    if (made.options == options) return made.view;
  }
  made_.push_back({options, view_query(query_, options, seed_, context_, timings_)});
  return made_.back().view;
}

std::size_t ViewCache::keypoints() const {
  std::size_t most = 0;
  for (const Made& made : made_) most = std::max(most, made.view.descriptors.size());
  return most;
}

std::optional<Gravity> gravity_of(const QueryOptions& options, const SceneRecord& record) {
  if (!options.up || !record.up) return std::nullopt;
  Gravity gravity;
  gravity.up_source = options.up->normalized().cast<float>();
  gravity.up_target = record.up->cast<float>();
  return gravity;
}

void assess_candidates(const SearchInput& input,
                       std::vector<Candidate> candidates,
                       const MeetingOf& meeting_of,
                       SearchResult& result) {
  std::stable_sort(candidates.begin(),
                   candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  candidates.resize(std::min(candidates.size(), kCoarse));
  std::vector<Assessed> assessed;
  {
    const StageTimer timer(input.timings.icp);
    assessed = assess_all_coarse(input, candidates, meeting_of, result);
  }
  const StageTimer timer(input.timings.verify);
  std::vector<Assessed> best = best_distinct(assessed, input.entries, input.query.centre);
  parallel_chunks(best.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      input.context.check("verify");
      assess_fine(meeting_of(result.matches[best[i].matches]),
                  input.entries[best[i].entry],
                  input.query,
                  best[i]);
    }
  });
  result.poses.insert(result.poses.end(), best.begin(), best.end());
}

}  // namespace landmarkdb
