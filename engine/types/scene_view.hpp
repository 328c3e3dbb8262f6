#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// What an entry holds about a pose, thinned for drawing. Positions are `origin` (double) + `points`
// (float), scene frame, metres.
struct SceneView {
  std::vector<Eigen::Vector3f> points;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::uint64_t scene_points = 0;     // that the entry holds
  double spacing_m = 0.0;             // of `points`
  bool whole = false;                 // nothing of the entry lies outside of the view
  std::optional<Eigen::Vector3d> up;  // unit, scene frame; where gravity is known
};

inline constexpr std::size_t kMostSceneViews = 3;  // of one answer, for its first hypotheses
inline constexpr std::uint32_t kMostSceneViewPoints = 50'000;  // of one view: 300 kB on the wire

}  // namespace landmarkdb
