#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::client {

// A pair as a line: its point in the sensor frame, then in the scene's. Metres.
using PairLine = std::array<double, 6>;

// A hypothesis as it is drawn. Directions are unit vectors of the scene frame.
struct DrawnCandidate {
  std::string scene;
  Eigen::Matrix4d T_scene_sensor = Eigen::Matrix4d::Identity();
  PoseChain chain;
  const SceneView* place = nullptr;  // of the QueryResult; null: the server sent none
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d above_right = Eigen::Vector3d::UnitX();  // what points right seen from above
  Eigen::Vector3d side_right =
      Eigen::Vector3d::UnitX();  // and from the side: where the sensor looks
  // Seen from above, what is higher (along `up`) hides the rest: a ceiling. Not set: nothing does.
  std::optional<double> cut_m;
  std::vector<PairLine> inliers;  // evenly chosen, at most kMostDrawnPairs
  std::vector<PairLine> rejected;
};

inline constexpr std::size_t kMostDrawnPairs = 400;
inline constexpr std::size_t kMostDrawnQueryPoints = 20'000;

// What a report's pictures show.
struct Drawing {
  std::vector<Eigen::Vector3f> query;  // thinned, sensor frame less `origin`
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d viewpoint = Eigen::Vector3d::Zero();     // sensor frame
  std::vector<std::vector<Eigen::Vector3d>> frustum;       // lines, sensor frame
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();           // sensor frame, for want of a candidate
  Eigen::Vector3d above_right = Eigen::Vector3d::UnitX();  // likewise
  Eigen::Vector3d side_right = Eigen::Vector3d::UnitX();
  std::vector<DrawnCandidate> candidates;  // those of the answer that have a scene view
};

// `cloud` is the query as it was sent. The drawing refers to `result`.
Drawing make_drawing(PointCloud cloud,
                     const std::optional<Eigen::Vector3d>& up_sensor,
                     const QueryResult& result);

}  // namespace landmarkdb::client
