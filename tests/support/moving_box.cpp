#include "tests/support/moving_box.hpp"

#include <string>
#include <vector>

#include "engine/geometry/pose.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/pose_equations.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb::testing {

MovingBox::MovingBox() {
  MonoModelRecord read;
  read.model = read_model(std::string(LANDMARKDB_SOURCE) + "/datasets/models/box.json", {}).model;
  read.triples = make_triples(read.model);
  record = std::make_shared<const MonoModelRecord>(std::move(read));
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  camera.dist[0] = -0.15;
}

Eigen::Isometry3d MovingBox::T_camera_object(int frame) const {
  constexpr double kStep_m = 0.003;
  constexpr double kStep_rad = 0.01;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(-2.2, Eigen::Vector3d::UnitX()).toRotationMatrix() *
               Eigen::AngleAxisd(2.6 + kStep_rad * frame, Eigen::Vector3d::UnitZ());
  T.translation() =
      Eigen::Vector3d(kStep_m * frame, 0.0, 0.42) - T.linear() * Eigen::Vector3d(0.06, 0.04, 0.03);
  return T;
}

ImageFeatures MovingBox::features(int frame) const {
  const MonoModel& model = record->model;
  const Eigen::Isometry3d T = T_camera_object(frame);
  const ModelVisibility visibility(model);
  const std::vector<bool> seen = visibility.points_from(T.inverse().translation());
  const std::vector<PosePoint> points = pose_points(model);
  ImageFeatures features;
  features.width = camera.width;
  features.height = camera.height;
  std::vector<int> place(model.points.size(), -1);
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    if (!seen[i]) continue;
    place[i] = static_cast<int>(features.points.size());
    ImageFeature feature;
    feature.type = model.points[i].type;
    feature.uv = distort(camera, seen_ray(points[i], {T.linear(), T.translation()}).ray);
    features.points.push_back(feature);
  }
  for (const auto& [a, b] : model.edges) {
    if (place[a] < 0 || place[b] < 0) continue;
    features.links.push_back(
        {static_cast<std::uint32_t>(place[a]), static_cast<std::uint32_t>(place[b])});
  }
  return features;
}

std::string arm_file(const MovingBox& box, int frame) {
  std::string goal;
  for (const double number : to_row_major(box.T_camera_object(frame).matrix())) {
    goal += (goal.empty() ? "" : ", ") + std::to_string(number);
  }
  return R"({"joints": [
    {"a": 0, "alpha": 1.570796326795, "d": 0, "min": -2.7925, "max": 2.7925, "rate": 1.5},
    {"a": 0.4318, "alpha": 0, "d": 0, "min": -0.7854, "max": 3.927, "rate": 1.2},
    {"a": 0.0203, "alpha": -1.570796326795, "d": 0.15005, "min": -3.927, "max": 0.7854, "rate": 1.5},
    {"a": 0, "alpha": 1.570796326795, "d": 0.4318, "min": -1.9199, "max": 2.9671, "rate": 3},
    {"a": 0, "alpha": -1.570796326795, "d": 0, "min": -1.7453, "max": 1.7453, "rate": 3},
    {"a": 0, "alpha": 0, "d": 0, "min": -4.6426, "max": 4.6426, "rate": 3}],
  "T_flange_camera": [1, 0, 0, 0.05, 0, 1, 0, 0, 0, 0, 1, 0.08, 0, 0, 0, 1],
  "q": [0.25, 0.585398, -2.891593, 0.3, 0.747198, 0.5],
  "T_camera_object": [)" +
         goal + "]}";
}

}  // namespace landmarkdb::testing
