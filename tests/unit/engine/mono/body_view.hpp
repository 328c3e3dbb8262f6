#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/refine_pose.hpp"
#include "engine/mono/search_model.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb::testing {

inline SearchModel plain_box(double x, double y, double z) {
  std::string points;
  for (int i = 0; i < 8; ++i) {
    const double at[3] = {(i & 1) != 0 ? x : 0.0, (i & 2) != 0 ? y : 0.0, (i & 4) != 0 ? z : 0.0};
    points += (i > 0 ? "," : "") + std::string("[") + std::to_string(at[0]) + "," +
              std::to_string(at[1]) + "," + std::to_string(at[2]) + "]";
  }
  const std::string text =
      R"({"name": "box", "units": "m", "points": [)" + points +
      R"(], "faces": [[0,2,3,1],[4,5,7,6],[0,1,5,4],[2,6,7,3],[0,4,6,2],[1,3,7,5]]})";
  auto record = std::make_shared<MonoModelRecord>();
  record->model = parse_model(std::as_bytes(std::span(text)), "box.json", {}).model;
  return prepare_model(record);
}

// A view of `seen` in which `model`, corner for corner, fits best.
struct View {
  RigidPose pose{};
  std::vector<PosePoint> points{};
  std::vector<std::uint32_t> numbers{};  // of the points, in the model
};

inline View look(const SearchModel& model,
                 const SearchModel& seen,
                 double noise_px,
                 std::uint64_t seed) {
  Random random(seed);
  const Camera camera = bent_camera();
  View view{{rotation_from_vector({0.7, -0.5, 0.3}), Eigen::Vector3d(0.02, -0.03, 0.7)}, {}, {}};
  const std::vector<bool> visible =
      seen.visibility.points_from(-(view.pose.R.transpose() * view.pose.t));
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    if (!visible[i] || model.model().points[i].type != FeatureType::kVertex) continue;
    PosePoint point = model.points[i];
    point.uv = *project(camera, view.pose * seen.points[i].xyz) +
               noise_px * Eigen::Vector2d(random.normal(), random.normal());
    point.sigma_px = 0.5;
    view.points.push_back(point);
    view.numbers.push_back(static_cast<std::uint32_t>(i));
  }
  RefineState state;
  EXPECT_TRUE(start_refinement(view.points, {}, camera, view.pose, {}, state));
  refine_steps(view.points, {}, camera, {}, 20, state);
  view.pose = state.pose;
  return view;
}

}  // namespace landmarkdb::testing
