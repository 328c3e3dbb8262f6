#include "engine/retrieval/rank_poses.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/registration/settle.hpp"

namespace landmarkdb {

namespace {

struct Scored {
  float score = 0.0F;
  std::uint32_t proposal = 0;
};

// Hands scored proposals out best first, sorted only as far as they are asked for.
class BestFirst {
 public:
  explicit BestFirst(std::vector<Scored> scored) : scored_(std::move(scored)) {}

  // Null when all were handed out.
  const Scored* next() {
    if (next_ == sorted_) sort_more();
    return next_ < sorted_ ? &scored_[next_++] : nullptr;
  }

 private:
  void sort_more() {
    constexpr std::size_t kFirst = 4096;
    const auto better = [](const Scored& a, const Scored& b) {
      return a.score != b.score ? a.score > b.score : a.proposal < b.proposal;
    };
    const auto at = [&](std::size_t i) { return scored_.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t end = std::min(std::max(kFirst, 2 * sorted_), scored_.size());
    if (end < scored_.size()) std::nth_element(at(sorted_), at(end), scored_.end(), better);
    std::sort(at(sorted_), at(end), better);
    sorted_ = end;
  }

  std::vector<Scored> scored_;
  std::size_t sorted_ = 0;
  std::size_t next_ = 0;
};

// What is left of a score for the test points that stand where the target is known to be empty.
float not_refuted(const SurfaceGrid& target,
                  const ScannedSpace& scanned,
                  const TestPoints& test,
                  const Proposal& proposal) {
  constexpr std::size_t kLooked = 128;
  const auto points = test.points().first(std::min(kLooked, test.size()));
  std::size_t empty = 0;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f p = proposal.R_target_source * point + proposal.t_target_source;
    empty += target.near(p) == nullptr && scanned.is_empty_at(p) ? 1U : 0U;
  }
  const float left = 1.0F - static_cast<float>(empty) / static_cast<float>(points.size());
  return left * left * left;
}

// Scores proposals[which[i]] with `points` test points each; those of no score are left out.
BestFirst score_all(const SurfaceGrid& target,
                    const TestPoints& test,
                    std::size_t points,
                    std::span<const Proposal> proposals,
                    std::span<const std::uint32_t> which,
                    const ScoreOptions& score,
                    const ScannedSpace* scanned,
                    const RunContext& context) {
  std::vector<Scored> scored(which.size());
  parallel_chunks(which.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    constexpr std::size_t kBetweenChecks = 4096;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBetweenChecks == 0) context.check("pose");
      const Proposal& proposal = proposals[which[i]];
      scored[i] = {
          score_pose(
              target, test, points, proposal.R_target_source, proposal.t_target_source, score),
          which[i]};
      if (scanned != nullptr && scanned->known() && scored[i].score > 0.0F) {
        scored[i].score *= not_refuted(target, *scanned, test, proposal);
      }
    }
  });
  std::erase_if(scored, [](const Scored& one) { return one.score <= 0.0F; });
  return BestFirst(std::move(scored));
}

struct GroupLimit {
  std::size_t kept = 0;
  std::size_t of_group = 0;
  double apart_m = 0.0;
  double apart_rad = 0.0;
};

// The best proposals, but only so many of each place: a right pose is proposed hundreds of times,
// and the look-alike it must be held against has to reach the finer test too.
std::vector<std::uint32_t> best_of_each_place(BestFirst& scored,
                                              std::span<const Proposal> proposals,
                                              const Eigen::Vector3d& centre,
                                              const GroupLimit& limit) {
  struct Group {
    Eigen::Vector3f centre;
    Eigen::Matrix3f R;
    std::size_t members = 0;
  };
  const Eigen::Vector3f middle = centre.cast<float>();
  const auto apart = static_cast<float>(limit.apart_m);
  const auto least_trace = static_cast<float>(1.0 + 2.0 * std::cos(limit.apart_rad));
  std::vector<Group> groups;
  std::vector<std::uint32_t> kept;
  while (kept.size() < limit.kept) {
    const Scored* next = scored.next();
    if (next == nullptr) break;
    const Proposal& proposal = proposals[next->proposal];
    const Eigen::Vector3f there = proposal.R_target_source * middle + proposal.t_target_source;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& other) {
      return (other.centre - there).squaredNorm() <= apart * apart &&
             other.R.cwiseProduct(proposal.R_target_source).sum() >= least_trace;  // trace(R^T R')
    });
    if (group == groups.end()) {
      groups.push_back({there, proposal.R_target_source, 0});
      group = groups.end() - 1;
    }
    if (group->members >= limit.of_group) continue;
    ++group->members;
    kept.push_back(next->proposal);
  }
  return kept;
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

std::vector<Proposal> settle_best(const SurfaceGrid& wide,
                                  const SurfaceGrid& fine,
                                  const TestPoints& test,
                                  std::span<const Proposal> proposals,
                                  const Eigen::Vector3d& centre,
                                  const SettleBestOptions& options,
                                  const RunContext& context) {
  std::vector<std::uint32_t> all(proposals.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  BestFirst scored = score_all(wide,
                               test,
                               options.first_points,
                               proposals,
                               all,
                               {.first_look = options.first_look, .hopeless = options.hopeless},
                               nullptr,
                               context);
  const std::vector<std::uint32_t> better =
      best_of_each_place(scored,
                         proposals,
                         centre,
                         {options.kept,
                          options.kept_of_group,
                          options.group_translation_cells * wide.cell_m(),
                          options.group_rotation_rad});
  std::vector<Proposal> settled;
  settled.reserve(better.size());
  for (const std::uint32_t i : better) settled.push_back(proposals[i]);
  parallel_chunks(settled.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Proposal& proposal = settled[i];
      settle_pose(
          wide, test, {.iterations = 2}, proposal.R_target_source, proposal.t_target_source);
      settle_pose(
          fine, test, {.iterations = 2}, proposal.R_target_source, proposal.t_target_source);
    }
  });
  return settled;
}

std::vector<RankedPose> rank_poses(const SurfaceGrid& target,
                                   const TestPoints& test,
                                   std::span<const Proposal> proposals,
                                   const Eigen::Vector3d& centre,
                                   const RankOptions& options,
                                   const RunContext& context) {
  std::vector<std::uint32_t> all(proposals.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  BestFirst scored = score_all(target,
                               test,
                               options.first_points,
                               proposals,
                               all,
                               {.hopeless = options.hopeless},
                               nullptr,
                               context);

  const std::vector<std::uint32_t> better =
      best_of_each_place(scored,
                         proposals,
                         centre,
                         {options.kept_first,
                          options.kept_of_group,
                          options.group_translation_cells * target.cell_m(),
                          options.group_rotation_rad});
  scored = score_all(target,
                     test,
                     options.second_points,
                     proposals,
                     better,
                     {.hopeless = options.hopeless},
                     options.scanned,
                     context);

  std::vector<RankedPose> ranked;
  while (ranked.size() < options.kept_last) {
    const Scored* next = scored.next();
    if (next == nullptr) break;
    const Eigen::Isometry3d T = pose_of(proposals[next->proposal]);
    const bool known = std::any_of(ranked.begin(), ranked.end(), [&](const RankedPose& other) {
      return same_pose(T,
                       other.T_target_source,
                       centre,
                       options.same_translation_cells * target.cell_m(),
                       options.same_rotation_rad);
    });
    if (!known) ranked.push_back({T, next->score, proposals[next->proposal].correspondence});
  }
  return ranked;
}

}  // namespace landmarkdb
