#include "engine/retrieval/search.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/retrieval/half_turns.hpp"
#include "engine/retrieval/verdict.hpp"

namespace landmarkdb {

namespace {

// How many go on from one pass to the next: the best of all, and of the entries that do best a few
// each, so that entries of different resolution, whose scores do not compare well, and look-alike
// places all reach the finer test.
struct Quota {
  std::size_t best = 0;
  std::size_t entries = 0;
  std::size_t each = 0;
};
constexpr Quota kCoarse{.best = 80, .entries = 10, .each = 10};
constexpr Quota kFine{.best = 24, .entries = 6, .each = 6};
// Objects do not compete but where they stand: each has its own.
constexpr Quota kCoarseObjects{.best = 80, .entries = 60, .each = 40};
constexpr Quota kFineObjects{.best = 20, .entries = 20, .each = 6};

// Those of `sorted` (best first) that the quota lets through, in their order.
template <typename Item, typename EntryOf>
std::vector<Item> within_quota(const std::vector<Item>& sorted,
                               const Quota& quota,
                               const EntryOf& entry_of) {
  std::map<std::size_t, std::size_t> taken;  // by entry
  std::vector<Item> kept;
  std::size_t seen = 0;
  for (const Item& item : sorted) {
    const auto known = taken.find(entry_of(item));
    if (known == taken.end() && taken.size() >= quota.entries && seen >= quota.best) continue;
    const std::size_t before = known == taken.end() ? 0 : known->second;
    if (seen >= quota.best && before >= quota.each) continue;
    ++taken[entry_of(item)];
    ++seen;
    kept.push_back(item);
  }
  return kept;
}

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
          assessed[i] = assess_coarse(meeting_of(matches),
                                      input.entries[matches.entry],
                                      input.query,
                                      candidates[i].T_entry_sensor);
          assessed[i].entry = matches.entry;
          assessed[i].matches = candidates[i].matches;
          assessed[i].candidate = i;
          assessed[i].correspondence = candidates[i].correspondence;
        }
      });
  std::stable_sort(assessed.begin(), assessed.end(), [](const Assessed& a, const Assessed& b) {
    return a.score > b.score;
  });
  return assessed;
}

// The best candidates of the test are looked at closely whatever the coarse look says: before the
// wide grid's cells a table or a rail close to the sensor stands in the way of half the view.
void put_best_tested_first(std::vector<Assessed>& assessed) {
  constexpr std::size_t kInAnyCase = 4;
  std::stable_partition(assessed.begin(), assessed.end(), [](const Assessed& pose) {
    return pose.candidate < kInAnyCase;
  });
}

// Half-turns of the best poses of each object, which proposals alone may miss, assessed as they are
// and sorted in among them.
void add_half_turns(const SearchInput& input,
                    const MeetingOf& meeting_of,
                    const SearchResult& result,
                    std::vector<Assessed>& assessed) {
  constexpr std::size_t kTurnedOfEach = 2;
  std::map<std::size_t, std::size_t> taken;  // by entry
  std::vector<Candidate> turned;
  for (const Assessed& pose : assessed) {
    if (++taken[pose.entry] > kTurnedOfEach) continue;
    for (const Eigen::Isometry3d& turn :
         half_turns(input.entries[pose.entry].record().prepared.points)) {
      turned.push_back({pose.matches, turn * pose.T_entry_sensor, 0.0F, pose.correspondence});
    }
  }
  const std::vector<Assessed> more = assess_all_coarse(input, turned, meeting_of, result);
  assessed.insert(assessed.end(), more.begin(), more.end());
  std::stable_sort(assessed.begin(), assessed.end(), [](const Assessed& a, const Assessed& b) {
    return a.score > b.score;
  });
}

// The best poses, one of each that refinement has carried to the same spot, and only so many of
// what the verdict takes for one place, so that its rivals are looked at as closely.
std::vector<Assessed> best_distinct(const std::vector<Assessed>& assessed,
                                    const Entries& entries,
                                    const Eigen::Vector3d& centre) {
  constexpr double kSameCells = 2.0;
  constexpr double kSameRad = 0.05;
  constexpr std::ptrdiff_t kMostOfOnePlace = 3;
  const VerdictOptions place;
  std::vector<Assessed> distinct;
  for (const Assessed& candidate : assessed) {
    const Entry& entry = entries[candidate.entry];
    const auto like = [&](double metres, double rad) {
      return std::count_if(distinct.begin(), distinct.end(), [&](const Assessed& other) {
        return same_spot(candidate, other, entry, centre, metres, rad);
      });
    };
    if (like(kSameCells * entry.grid.cell_m(), kSameRad) > 0) continue;
    if (like(place_radius_m(entry, place), place.different_rotation_rad) >= kMostOfOnePlace)
      continue;
    distinct.push_back(candidate);
  }
  const bool objects = !distinct.empty() && entries[distinct.front().entry].is_object();
  return within_quota(
      distinct, objects ? kFineObjects : kFine, [](const Assessed& pose) { return pose.entry; });
}

// Looks at the poses side by side.
void assess_each(const SearchInput& input,
                 const MeetingOf& meeting_of,
                 const SearchResult& result,
                 decltype(assess_fine)* assess,
                 std::span<Assessed> poses) {
  parallel_each(poses.size(), input.context.threads, [&](std::size_t i) {
    input.context.check("verify");
    assess(meeting_of(result.matches[poses[i].matches]),
           input.entries[poses[i].entry],
           input.query,
           poses[i]);
  });
}

// Makes what is looked at from these poses, each on all threads: of one place, as a rule, and the
// poses would wait for one another.
void make_sight_of(const SearchInput& input, std::span<const Assessed> poses) {
  for (const Assessed& pose : poses) {
    input.context.check("verify");
    input.entries[pose.entry].sight.get(input.context.threads);
  }
}

// Poses of places that may turn out the best, or a rival that counts, are assessed to the last;
// best first, a few at a time, until none of the others is within reach of the best.
void assess_within_reach(const SearchInput& input,
                         const MeetingOf& meeting_of,
                         const SearchResult& result,
                         std::vector<Assessed>& poses) {
  constexpr std::size_t kAtATime = 4;
  constexpr double kReach =
      0.5;  // of the best score; a rival below 0.6 counts nothing (verdict.cpp)
  std::stable_sort(poses.begin(), poses.end(), [](const Assessed& a, const Assessed& b) {
    return a.score > b.score;
  });
  double best = poses.empty() ? 0.0 : poses.front().score;
  for (std::size_t first = 0; first < poses.size();) {
    const auto end = std::find_if(
        poses.begin() + static_cast<std::ptrdiff_t>(first),
        poses.begin() + static_cast<std::ptrdiff_t>(std::min(first + kAtATime, poses.size())),
        [&](const Assessed& pose) { return pose.score < kReach * best; });
    const std::span within(poses.begin() + static_cast<std::ptrdiff_t>(first), end);
    if (within.empty()) break;
    make_sight_of(input, within);
    assess_each(input, meeting_of, result, &assess_precisely, within);
    if (first == 0) best = 0.0;  // as it was assessed less closely
    for (const Assessed& pose : within) best = std::max(best, pose.score);
    first += within.size();
  }
}

}  // namespace

const QueryView& ViewCache::add(const FeatureOptions& options,
                                const std::function<QueryView()>& make,
                                std::list<Made>& made) {
  made.push_back({options, {}});
  try {
    made.back().view = make();
  } catch (const Error& error) {
    // Too small, too flat or too wide a cloud at this resolution; another entry's may suit it.
    if (error.code() != ErrorCode::kInvalidArgument) throw;
  }
  return made.back().view;
}

const QueryView& ViewCache::at(const FeatureOptions& options) {
  for (const Made& made : made_) {
    if (made.options == options) return made.view;
  }
  return add(
      options, [&] { return view_query(query_, options, seed_, context_, timings_); }, made_);
}

const QueryView& ViewCache::dense_at(const FeatureOptions& options) {
  for (const Made& made : dense_) {
    if (made.options == options) return made.view;
  }
  const CleanQuery dense = [&] {
    const StageTimer timer(timings_.preprocess);
    return dense_part(query_, kMostSpacingVoxels * options.voxel_m, context_);
  }();
  return add(
      options, [&] { return view_for_objects(dense, options, context_, timings_); }, dense_);
}

std::size_t ViewCache::keypoints() const {
  std::size_t most = 0;
  for (const auto* list : {&made_, &dense_}) {
    for (const Made& made : *list) most = std::max(most, made.view.descriptors.size());
  }
  return most;
}

FeatureOptions query_features(FeatureOptions of_entry, const QueryOptions& options) {
  if (options.keypoints) of_entry.keypoints = *options.keypoints;
  return of_entry;
}

std::shared_ptr<const DescriptorIndex> index_over(const SearchInput& input, std::size_t entry) {
  const std::vector<float>& values = input.entries[entry].record().descriptors.values;
  return input.indexes.get(input.entries.key(entry),
                           values.size() / kShotLength,
                           input.options.measure,
                           input.options.search,
                           [&] { return values; });
}

std::shared_ptr<const DescriptorIndex> index_over(const SearchInput& input, const Level& level) {
  const auto values = [&] { return level_values(input.entries, level.entries, input.context); };
  const bool lasting = std::any_of(input.levels.begin(),
                                   input.levels.end(),
                                   [&](const Level& other) { return &other == &level; });
  const QueryOptions& options = input.options;
  return lasting ? input.indexes.get(&level, level.rows(), options.measure, options.search, values)
                 : make_index(values(), options.measure, options.search);
}

std::optional<Gravity> gravity_of(const QueryOptions& options, const SceneRecord& record) {
  if (!options.up || !record.up) return std::nullopt;
  Gravity gravity;
  gravity.up_source = options.up->stableNormalized().cast<float>();
  gravity.up_target = record.up->cast<float>();
  return gravity;
}

std::optional<PositionPrior> prior_of(const SearchInput& input, const SceneRecord& record) {
  const QueryOptions& options = input.options;
  if (!options.prior_T_scene_sensor) return std::nullopt;
  PositionPrior prior;
  prior.centre =
      (options.prior_T_scene_sensor->translation() - record.prepared.origin).cast<float>();
  prior.sensor_source = -input.query.cloud.origin.cast<float>();
  prior.radius_m = static_cast<float>(options.prior_radius_m);
  return prior;
}

void assess_candidates(const SearchInput& input,
                       std::vector<Candidate> candidates,
                       const MeetingOf& meeting_of,
                       SearchResult& result) {
  std::stable_sort(candidates.begin(),
                   candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  const auto entry_of = [&](const Candidate& candidate) {
    return result.matches[candidate.matches].entry;
  };
  const bool objects =
      !candidates.empty() && input.entries[entry_of(candidates.front())].is_object();
  candidates = within_quota(candidates, objects ? kCoarseObjects : kCoarse, entry_of);
  for (const Candidate& candidate : candidates) ++result.matches[candidate.matches].poses.refined;
  std::vector<Assessed> assessed;
  {
    const StageTimer timer(input.timings.icp);
    assessed = assess_all_coarse(input, candidates, meeting_of, result);
    if (objects) {
      add_half_turns(input, meeting_of, result, assessed);
    } else {
      put_best_tested_first(assessed);
    }
  }
  const StageTimer timer(input.timings.verify);
  std::vector<Assessed> best = best_distinct(assessed, input.entries, input.query.centre);
  assess_each(input, meeting_of, result, &assess_fine, best);
  if (!objects) assess_within_reach(input, meeting_of, result, best);
  for (const Assessed& pose : best) ++result.matches[pose.matches].poses.verified;
  result.poses.insert(result.poses.end(), best.begin(), best.end());
}

}  // namespace landmarkdb
