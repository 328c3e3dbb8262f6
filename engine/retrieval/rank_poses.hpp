#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/registration/pose_score.hpp"
#include "engine/registration/propose.hpp"
#include "engine/registration/scanned_space.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

struct RankOptions {
  std::size_t first_points = 96;    // of the test points, for every proposal
  std::size_t second_points = 400;  // for those that did well
  std::size_t kept_first = 400;
  std::size_t kept_of_group = 12;  // of those, at most so many of one place
  double group_translation_cells = 10.0;
  double group_rotation_rad = 0.175;
  std::size_t kept_last = 40;  // distinct ones, to be refined
  float hopeless = 0.15F;  // mean score of the first few points below which a proposal is given up
  double same_translation_cells = 4.0;  // proposals closer than both are one
  double same_rotation_rad = 0.12;
  // Of the target; those that did well then lose by what stands where it is known to be empty.
  const ScannedSpace* scanned = nullptr;
};

struct SettleBestOptions {
  std::size_t first_points = 48;  // of the test points, for every proposal on the wide grid
  std::size_t kept = 1500;        // to be settled
  std::size_t kept_of_group = 8;  // of those, at most so many of one place
  double group_translation_cells = 3.0;
  double group_rotation_rad = 0.175;
  std::size_t first_look = 16;  // points after which a hopeless proposal is given up
  float hopeless = 0.2F;
};

// What one local reference frame proposes is off by decimetres and tens of degrees where the
// descriptor's support was half hidden, too far for the fine grid to tell it from chance. So every
// proposal is tested on `wide`, the same surface in cells a few times as large, and the better ones
// are settled there and on `fine` before their score is asked for.
std::vector<Proposal> settle_best(const SurfaceGrid& wide,
                                  const SurfaceGrid& fine,
                                  const TestPoints& test,
                                  std::span<const Proposal> proposals,
                                  const Eigen::Vector3d& centre,
                                  const SettleBestOptions& options,
                                  const RunContext& context);

struct RankedPose {
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  float score = 0.0F;
  std::uint32_t correspondence = 0;  // that proposed it
};

// Tests every proposal on the target's surface, the better ones with more points, and returns the
// best distinct ones, best first. `centre` (source frame) is where two poses are compared. Same
// input, same answer for any `context.threads`.
std::vector<RankedPose> rank_poses(const SurfaceGrid& target,
                                   const TestPoints& test,
                                   std::span<const Proposal> proposals,
                                   const Eigen::Vector3d& centre,
                                   const RankOptions& options,
                                   const RunContext& context);

// True when the two poses carry `centre` to within `translation_m` of each other and turn it alike.
bool same_pose(const Eigen::Isometry3d& a,
               const Eigen::Isometry3d& b,
               const Eigen::Vector3d& centre,
               double translation_m,
               double rotation_rad);

}  // namespace landmarkdb
