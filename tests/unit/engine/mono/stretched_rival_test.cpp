#include "engine/mono/stretched_rival.hpp"

#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/refine_pose.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

SearchModel box(double x, double y, double z) {
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
};

View look(const SearchModel& model, const SearchModel& seen, double noise_px, std::uint64_t seed) {
  Random random(seed);
  const Camera camera = testing::bent_camera();
  View view{{rotation_from_vector({0.7, -0.5, 0.3}), Eigen::Vector3d(0.02, -0.03, 0.7)}, {}};
  const std::vector<bool> visible =
      seen.visibility.points_from(-(view.pose.R.transpose() * view.pose.t));
  for (std::size_t i = 0; i < 8; ++i) {
    if (!visible[i]) continue;
    PosePoint point = model.points[i];
    point.uv = *project(camera, view.pose * seen.points[i].xyz) +
               noise_px * Eigen::Vector2d(random.normal(), random.normal());
    point.sigma_px = 0.5;
    view.points.push_back(point);
  }
  RefineState state;
  EXPECT_TRUE(start_refinement(view.points, {}, camera, view.pose, {}, state));
  refine_steps(view.points, {}, camera, {}, 20, state);
  view.pose = state.pose;
  return view;
}

TEST(StretchedRival, SpeaksForABodyOfTheModelsProportions) {
  const SearchModel model = box(0.10, 0.13, 0.08);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const View view = look(model, model, 0.3, seed);
    const Stretch stretch =
        stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
    EXPECT_GT(stretch.log10_odds, 0.5) << seed;
    EXPECT_LT(stretch.log_ratios.norm(), 0.1) << seed;
  }
}

TEST(StretchedRival, MeasuresOtherProportionsAndSpeaksAgainstThem) {
  const SearchModel model = box(0.10, 0.13, 0.08), other = box(0.10, 0.13, 0.092);
  const View view = look(model, other, 0.0, 1);
  ASSERT_GE(view.points.size(), 7U);
  const Stretch stretch =
      stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
  EXPECT_LT(stretch.log10_odds, -1.0);
  // Which axis is which is the solver's choice: the longest change is that of z, the mean is taken
  // off.
  EXPECT_NEAR(stretch.log_ratios.cwiseAbs().maxCoeff(), 2.0 / 3.0 * std::log(0.092 / 0.08), 0.01);
  EXPECT_NEAR(stretch.log_ratios.sum(), 0.0, 1e-9);
}

TEST(StretchedRival, DoesNotSayWhatTheViewDoesNotShow) {
  const SearchModel model = box(0.10, 0.13, 0.08);
  View view = look(model, model, 0.0, 1);
  view.points.resize(4);  // fix the pose and two numbers: proportions fit whatever they are
  const Stretch few = stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
  EXPECT_LT(std::abs(few.log10_odds), 4.0);
  EXPECT_EQ(stretched_rival(model, testing::bent_camera(), view.pose, {}, {}).log10_odds, 0.0);
}

TEST(StretchAxes, AreTheEdgesOfABox) {
  const Eigen::Matrix3d axes = stretch_axes(box(0.10, 0.13, 0.08));
  EXPECT_TRUE((axes.transpose() * axes).isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  for (Eigen::Index k = 0; k < 3; ++k) EXPECT_NEAR(axes.col(k).cwiseAbs().maxCoeff(), 1.0, 1e-9);
}

}  // namespace
}  // namespace landmarkdb
