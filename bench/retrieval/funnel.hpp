#pragma once

#include <cstddef>
#include <string>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/level.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::bench {

// Where the right pose was still there. Near: within 0.5 m and 12 deg, what refinement can bring
// home.
struct Funnel {
  std::size_t keypoints = 0;
  std::size_t proposals = 0;
  std::size_t near_proposals = 0;   // of all proposals of the right entry
  std::size_t loose_proposals = 0;  // within 0.8 m at the query's centre and 25 deg
  int ranked = -1;                  // place of the first near one after testing; -1: lost
  double nearest_m = 1e9;  // of the poses assessed in the right entry: how near the best one came
  // Score of the pose that refinement makes of the truth itself, and how far it carries it.
  double truth_score = 0.0;
  double truth_drift_m = 0.0;
  double best_score = 0.0;  // of the poses assessed
  int assessed = -1;        // place by quality of the first right one after refinement; -1: lost
};

// Follows the right pose of a place through the search stage by stage.
Funnel follow(const PointCloud& cloud,
              const QueryOptions& options,
              const std::vector<Entry>& entries,
              std::span<const Level> levels,
              std::size_t right_entry,
              const Eigen::Isometry3d& T_scene_sensor,
              const RunContext& context);

}  // namespace landmarkdb::bench
