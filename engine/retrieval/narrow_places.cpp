#include "engine/retrieval/narrow_places.hpp"

#include <algorithm>

#include "engine/base/parallel.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/settle.hpp"

namespace landmarkdb {

namespace {

// Proposals settled on the wide grids: shared among the places, and at least so many of each.
constexpr std::size_t kTried = 16'000;
constexpr std::size_t kTriedAtLeast = 16;
// The first test is that of settle_best, the last one finer than its grid's cell, as the pose has
// been settled by then.
constexpr std::size_t kFirstPoints = 48;
constexpr ScoreOptions kFirst{.sigma_cells = 1.0F, .first_look = 16, .hopeless = 0.2F};
constexpr std::size_t kLastPoints = 400;
constexpr ScoreOptions kLast{.sigma_cells = 0.4F, .first_look = kLastPoints, .hopeless = 0.0F};

struct Tried {
  float score = 0.0F;
  std::uint32_t proposal = 0;
};

double score_of(const SearchInput& input, const EntryMatches& matches, std::size_t tried) {
  const Entry& entry = input.entries[matches.entry];
  const TestPoints& test = matches.view->test;
  const std::vector<Proposal> proposals =
      propose_from_frames(matches.putative,
                          entry.record().descriptors,
                          matches.view->descriptors,
                          gravity_of(input.options, entry.record()),
                          prior_of(input, entry.record()));
  std::vector<Tried> all(proposals.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const Proposal& p = proposals[i];
    all[i] = {
        score_pose(entry.wide, test, kFirstPoints, p.R_target_source, p.t_target_source, kFirst),
        i};
  }
  const std::size_t count = std::min(tried, all.size());
  std::partial_sort(all.begin(),
                    all.begin() + static_cast<std::ptrdiff_t>(count),
                    all.end(),
                    [](const Tried& a, const Tried& b) {
                      return a.score != b.score ? a.score > b.score : a.proposal < b.proposal;
                    });
  float best = 0.0F;
  for (std::size_t i = 0; i < count && all[i].score > 0.0F; ++i) {
    Proposal p = proposals[all[i].proposal];
    settle_pose(entry.wide, test, {}, p.R_target_source, p.t_target_source);
    best = std::max(
        best,
        score_pose(entry.wide, test, kLastPoints, p.R_target_source, p.t_target_source, kLast));
  }
  return static_cast<double>(best);
}

}  // namespace

std::vector<double> place_scores(const SearchInput& input, std::span<const EntryMatches> matches) {
  const std::size_t tried =
      std::max(kTriedAtLeast, kTried / std::max<std::size_t>(matches.size(), 1));
  std::vector<double> scores(matches.size(), 0.0);
  parallel_chunks(matches.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t m = begin; m < end; ++m) {
      input.context.check("pose");
      scores[m] = score_of(input, matches[m], tried);
    }
  });
  return scores;
}

std::vector<std::size_t> best_places(std::span<const double> scores, std::size_t most) {
  std::vector<std::size_t> order(scores.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return scores[a] > scores[b];
  });
  if (order.size() > most) order.resize(most);
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace landmarkdb
