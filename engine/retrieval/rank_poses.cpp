#include "engine/retrieval/rank_poses.hpp"

#include <algorithm>

#include "engine/base/parallel.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {

namespace {

struct Scored {
  float score = 0.0F;
  std::uint32_t proposal = 0;
};

// Scores proposals[which[i]] with `points` test points each.
std::vector<Scored> score_all(const SurfaceGrid& target,
                              const TestPoints& test,
                              std::size_t points,
                              std::span<const Proposal> proposals,
                              std::span<const std::uint32_t> which,
                              float hopeless,
                              const RunContext& context) {
  std::vector<Scored> scored(which.size());
  ScoreOptions score;
  score.hopeless = hopeless;
  parallel_chunks(which.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t kBetweenChecks = 4096;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBetweenChecks == 0) context.check("pose");
      const Proposal& proposal = proposals[which[i]];
      scored[i] = {
          score_pose(
              target, test, points, proposal.R_target_source, proposal.t_target_source, score),
          which[i]};
    }
  });
  std::sort(scored.begin(), scored.end(), [](const Scored& a, const Scored& b) {
    return a.score != b.score ? a.score > b.score : a.proposal < b.proposal;
  });
  return scored;
}

Eigen::Isometry3d pose_of(const Proposal& proposal) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = nearest_rotation(proposal.R_target_source.cast<double>());
  T.translation() = proposal.t_target_source.cast<double>();
  return T;
}

}  // namespace

bool same_pose(const Eigen::Isometry3d& a,
               const Eigen::Isometry3d& b,
               const Eigen::Vector3d& centre,
               double translation_m,
               double rotation_rad) {
  return (a * centre - b * centre).norm() <= translation_m &&
         rotation_angle_rad(a.linear().transpose() * b.linear()) <= rotation_rad;
}

std::vector<RankedPose> rank_poses(const SurfaceGrid& target,
                                   const TestPoints& test,
                                   std::span<const Proposal> proposals,
                                   const Eigen::Vector3d& centre,
                                   const RankOptions& options,
                                   const RunContext& context) {
  std::vector<std::uint32_t> all(proposals.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  std::vector<Scored> scored =
      score_all(target, test, options.first_points, proposals, all, options.hopeless, context);

  std::vector<std::uint32_t> better;
  for (const Scored& s : scored) {
    if (better.size() >= options.kept_first || s.score <= 0.0F) break;
    better.push_back(s.proposal);
  }
  scored =
      score_all(target, test, options.second_points, proposals, better, options.hopeless, context);

  std::vector<RankedPose> ranked;
  for (const Scored& s : scored) {
    if (ranked.size() >= options.kept_last || s.score <= 0.0F) break;
    const Eigen::Isometry3d T = pose_of(proposals[s.proposal]);
    const bool known = std::any_of(ranked.begin(), ranked.end(), [&](const RankedPose& other) {
      return same_pose(T,
                       other.T_target_source,
                       centre,
                       options.same_translation_cells * target.cell_m(),
                       options.same_rotation_rad);
    });
    if (!known) ranked.push_back({T, s.score, proposals[s.proposal].correspondence});
  }
  return ranked;
}

}  // namespace landmarkdb
