#include "engine/mono/tracker.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include <gtest/gtest.h>

#include "datasets/mono/render_model.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
using testing::box_record;
using testing::PoseNear;

Camera make_camera(double k1) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.dist[0] = k1;
  return camera;
}

// A box that comes nearer, wanders and turns: 3 to 5 px a frame.
Eigen::Isometry3d box_at(int frame) {
  const double s = 0.1 * frame;
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector({0.9 + 0.1 * s, 0.5 - 0.15 * s, 0.2 * s});
  T.translation() = Eigen::Vector3d(-0.05 + 0.04 * s, 0.02 * s, 0.7 - 0.03 * s);
  return T;
}

GreyImage picture(const Camera& camera, int frame, int clutter = 0) {
  return datasets::render_model(
      box_record()->model, camera, box_at(frame), {.noise = 2.0, .clutter = clutter, .samples = 4});
}

TEST(Tracker, FollowsABoxThroughALensThatBends) {
  for (const double k1 : {0.0, -0.25}) {
    const Camera camera = make_camera(k1);
    Tracker tracker(box_record(), camera, {}, nullptr);
    tracker.start_from(box_at(0));
    for (int frame = 0; frame < 12; ++frame) {
      const TrackResult result = tracker.next(picture(camera, frame), {});
      ASSERT_EQ(result.status, TrackStatus::kTracked) << "frame " << frame << ": " << result.reason;
      EXPECT_THAT(*result.T_camera_object, PoseNear(box_at(frame), 2e-3, 0.5 * kDegree));
      EXPECT_GT(result.edge_share, 0.7);  // two of its faces are nearly of one grey
      EXPECT_LT(result.rms_px, 0.6);
      EXPECT_GE(result.matched, 5U);
      EXPECT_GT(result.covariance.diagonal().minCoeff(), 0.0);
    }
  }
}

TEST(Tracker, FindsABoxThatIsFifteenPixelsFromWhereItWas) {
  const Camera camera = make_camera(0.0);
  Eigen::Isometry3d off = box_at(0);
  off.translation() += Eigen::Vector3d(0.012, -0.010, 0.0);  // 13 px
  Tracker tracker(box_record(), camera, {}, nullptr);
  tracker.start_from(off);
  const TrackResult result = tracker.next(picture(camera, 0), {});
  ASSERT_EQ(result.status, TrackStatus::kTracked);
  EXPECT_THAT(*result.T_camera_object, PoseNear(box_at(0), 2e-3, 0.5 * kDegree));
}

TEST(Tracker, KeepsItsRotationsRotationsHoweverLongItRuns) {
  // Rounding once grew by 2.6 a frame, through the predicted motion, until the pose was useless.
  const Camera camera = make_camera(0.0);
  Tracker tracker(box_record(), camera, {}, nullptr);
  tracker.start_from(box_at(0));
  const GreyImage image = picture(camera, 0);
  for (int frame = 0; frame < 150; ++frame) {
    const TrackResult result = tracker.next(image, {});
    ASSERT_EQ(result.status, TrackStatus::kTracked) << frame;
    const Eigen::Matrix3d R = result.T_camera_object->linear();
    ASSERT_LT((R * R.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << frame;
  }
}

TEST(Tracker, PredictsThroughAShortLossAndSaysSo) {
  const Camera camera = make_camera(0.0);
  Tracker tracker(box_record(), camera, {}, nullptr);
  tracker.start_from(box_at(0));
  for (int frame = 0; frame < 4; ++frame) tracker.next(picture(camera, frame), {});
  const GreyImage empty = {640, 480, std::vector<std::uint8_t>(640 * 480, 90)};
  for (int frame = 4; frame < 6; ++frame) {
    const TrackResult result = tracker.next(empty, {});
    EXPECT_EQ(result.status, TrackStatus::kPredicted);
    EXPECT_FALSE(result.measured());
    EXPECT_FALSE(result.reason.empty());
    EXPECT_THAT(*result.T_camera_object, PoseNear(box_at(frame), 10e-3, 2.0 * kDegree));
  }
  const TrackResult again = tracker.next(picture(camera, 6), {});
  EXPECT_EQ(again.status, TrackStatus::kTracked);
  EXPECT_THAT(*again.T_camera_object, PoseNear(box_at(6), 2e-3, 0.5 * kDegree));
}

TEST(Tracker, IsLostAfterThreeFramesWithoutTheObject) {
  const Camera camera = make_camera(0.0);
  Tracker tracker(box_record(), camera, {}, nullptr);
  tracker.start_from(box_at(0));
  const GreyImage empty = {640, 480, std::vector<std::uint8_t>(640 * 480, 90)};
  EXPECT_EQ(tracker.next(empty, {}).status, TrackStatus::kPredicted);
  EXPECT_EQ(tracker.next(empty, {}).status, TrackStatus::kPredicted);
  for (int frame = 0; frame < 3; ++frame) {
    const TrackResult lost = tracker.next(empty, {});
    EXPECT_EQ(lost.status, TrackStatus::kLost);
    EXPECT_FALSE(lost.T_camera_object.has_value());
  }
  EXPECT_EQ(tracker.next(picture(camera, 0), {}).status, TrackStatus::kLost)
      << "nothing to recognise it with";
}

TEST(Tracker, DoesNotBelieveClutterWithoutTheObject) {
  const Camera camera = make_camera(0.0);
  int believed = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const GreyImage clutter = datasets::render_models(
        {}, camera, {.noise = 2.0, .clutter = 25, .samples = 2, .seed = seed});
    Tracker tracker(box_record(), camera, {}, nullptr);
    tracker.start_from(box_at(0));
    believed += tracker.next(clutter, {}).measured() ? 1 : 0;
  }
  EXPECT_LE(believed, 1);
}

// Feature points of the box, off by a tenth of a pixel in turn.
ImageFeatures points_of_box(const Camera& camera, const Eigen::Isometry3d& T) {
  ImageFeatures features;
  features.width = camera.width;
  features.height = camera.height;
  const MonoModel& model = box_record()->model;
  const ModelVisibility visibility(model);
  const std::vector<bool> seen = visibility.points_from(T.inverse().translation());
  double wobble = 0.1;
  for (std::size_t k = 0; k < model.points.size(); ++k) {
    if (!seen[k] || model.points[k].type != FeatureType::kVertex) continue;
    wobble = -wobble;
    features.points.push_back(
        {.uv = *project(camera, T * model.points[k].xyz) + Eigen::Vector2d(wobble, 0.05)});
  }
  return features;
}

TEST(Tracker, FollowsFeaturePointsAlone) {
  const Camera camera = make_camera(-0.25);
  Tracker tracker(box_record(), camera, {}, nullptr);
  tracker.start_from(box_at(0));
  for (int frame = 0; frame < 20; ++frame) {
    ImageFeatures features = points_of_box(camera, box_at(frame));
    features.points.push_back({.uv = {10.0, 20.0}});
    const TrackResult result = tracker.next(features, {});
    ASSERT_EQ(result.status, TrackStatus::kTracked) << frame << ": " << result.reason;
    EXPECT_THAT(*result.T_camera_object, PoseNear(box_at(frame), 3e-3, 0.5 * kDegree));
    EXPECT_GE(result.matched, 6U);
  }
}

TEST(Tracker, RefusesWhatDoesNotFit) {
  const Camera camera = make_camera(0.0);
  Tracker tracker(box_record(), camera, {}, nullptr);
  EXPECT_THROW(tracker.next(GreyImage{320, 240, std::vector<std::uint8_t>(320 * 240)}, {}), Error);
  EXPECT_THROW(tracker.next(GreyImage{640, 480, std::vector<std::uint8_t>(100)}, {}), Error);
  ImageFeatures features;
  features.points.push_back({.uv = {std::numeric_limits<double>::quiet_NaN(), 1.0}});
  EXPECT_THROW(tracker.next(features, {}), Error);
  EXPECT_THROW(Tracker(box_record(), camera, {.reach_px = 0.0}, nullptr), Error);
  EXPECT_THROW(Tracker(box_record(), camera, {.min_edge_share = 1.5}, nullptr), Error);
  Eigen::Isometry3d bad = box_at(0);
  bad.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(tracker.start_from(bad), Error);
  bad = box_at(0);
  bad.translation().z() = -0.5;
  EXPECT_THROW(tracker.start_from(bad), Error);
  EXPECT_EQ(tracker.next(ImageFeatures{}, {}).status, TrackStatus::kLost);
}

TEST(Tracker, StopsWhenAskedTo) {
  const Camera camera = make_camera(0.0);
  Tracker tracker(box_record(), camera, {}, nullptr);
  std::stop_source stop;
  stop.request_stop();
  RunContext run;
  run.stop = stop.get_token();
  EXPECT_THROW(tracker.next(picture(camera, 0), run), Error);
}

TEST(TrackStatus, HasNames) {
  EXPECT_EQ(to_string(TrackStatus::kTracked), "tracked");
  EXPECT_EQ(to_string(TrackStatus::kRecognized), "recognized");
  EXPECT_EQ(to_string(TrackStatus::kPredicted), "predicted");
  EXPECT_EQ(to_string(TrackStatus::kLost), "lost");
}

}  // namespace
}  // namespace landmarkdb
