#include "engine/mono/align_model.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

using testing::bent_camera;
using testing::box_record;

RigidPose truth() { return {rotation_from_vector({0.9, 0.5, 0.2}), {0.01, -0.02, 0.6}}; }

RigidPose start() {
  return {rotation_from_vector({0.02, -0.015, 0.01}) * truth().R,
          truth().t + Eigen::Vector3d(0.003, -0.002, 0.006)};
}

// Candidates where the true pose puts each sample, and one wrong one for `wrong` of them.
EdgeCandidates candidates_for(const std::vector<TrackSample>& samples,
                              double wrong,
                              Random& random) {
  EdgeCandidates result;
  for (const TrackSample& sample : samples) {
    const Eigen::Vector2d uv = *project(bent_camera(), truth() * sample.xyz);
    const auto offset = static_cast<float>((uv - sample.uv).dot(sample.normal));
    if (random.uniform() < wrong) {
      result.list.push_back(
          {.offset_px = offset + static_cast<float>((random.below(2) == 0 ? 1.0 : -1.0) *
                                                    random.uniform(4.0, 12.0))});
    } else {
      result.list.push_back({.offset_px = offset});
    }
    result.starts.push_back(static_cast<std::uint32_t>(result.list.size()));
  }
  return result;
}

// Aligns, and again from there, as a tracker does.
Alignment align_twice(double wrong) {
  Random random(3);
  Alignment result;
  result.pose = start();
  for (int round = 0; round < 3; ++round) {
    const std::vector<TrackSample> samples = track_samples(
        box_record()->model, ModelVisibility(box_record()->model), bent_camera(), result.pose, {});
    result = align_model(
        samples, candidates_for(samples, wrong, random), {}, bent_camera(), result.pose, {});
  }
  return result;
}

TEST(AlignModel, FindsThePoseFromEdgesAlone) {
  const Alignment result = align_twice(0.0);
  EXPECT_TRUE(result.fixed);
  EXPECT_THAT(result.pose.isometry(), testing::PoseNear(truth().isometry(), 1e-5, 1e-5));
  EXPECT_LT(result.rms_px, 0.01);
}

TEST(AlignModel, IsNotDrawnAwayByAThirdOfWrongEdges) {
  const Alignment result = align_twice(0.33);
  EXPECT_THAT(result.pose.isometry(), testing::PoseNear(truth().isometry(), 2e-4, 1e-3));
}

TEST(AlignModel, FindsThePoseFromPointsAlone) {
  std::vector<PosePoint> points;
  for (const ModelFeature& feature : box_record()->model.points) {
    if (feature.type != FeatureType::kVertex) continue;
    points.push_back({.xyz = feature.xyz, .uv = *project(bent_camera(), truth() * feature.xyz)});
  }
  const Alignment result = align_model({}, {}, points, bent_camera(), start(), {});
  EXPECT_TRUE(result.fixed);
  EXPECT_THAT(result.pose.isometry(), testing::PoseNear(truth().isometry(), 1e-6, 1e-6));
}

TEST(AlignModel, SaysWhenTooLittleFixesThePose) {
  const Alignment nothing = align_model({}, {}, {}, bent_camera(), start(), {});
  EXPECT_FALSE(nothing.fixed);
  EXPECT_EQ(nothing.pose.t, start().t);
  // One edge leaves four freedoms.
  std::vector<TrackSample> samples = track_samples(
      box_record()->model, ModelVisibility(box_record()->model), bent_camera(), start(), {});
  std::erase_if(samples, [&](const TrackSample& s) { return s.curve != samples.front().curve; });
  ASSERT_GE(samples.size(), 6U);
  Random random(1);
  EXPECT_FALSE(
      align_model(samples, candidates_for(samples, 0.0, random), {}, bent_camera(), start(), {})
          .fixed);
}

}  // namespace
}  // namespace landmarkdb
