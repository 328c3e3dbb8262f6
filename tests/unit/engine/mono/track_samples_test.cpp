#include "engine/mono/track_samples.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

using testing::bent_camera;
using testing::box_record;

RigidPose pose() { return {rotation_from_vector({0.9, 0.5, 0.2}), {0.0, 0.0, 0.6}}; }

std::vector<TrackSample> samples_of(const MonoModel& model,
                                    const RigidPose& at,
                                    const TrackSampleOptions& options = {}) {
  return track_samples(model, ModelVisibility(model), bent_camera(), at, options);
}

TEST(TrackSamples, LieWhereTheirPlacesAreSeenAndPointAcrossTheirEdge) {
  const MonoModel& model = box_record()->model;
  const std::vector<TrackSample> samples = samples_of(model, pose());
  ASSERT_GT(samples.size(), 50U);
  for (const TrackSample& sample : samples) {
    EXPECT_LT((*project(bent_camera(), pose() * sample.xyz) - sample.uv).norm(), 1e-9);
    EXPECT_NEAR(sample.normal.norm(), 1.0, 1e-12);
    const auto& [from, to] = model.edges[sample.curve];
    const Eigen::Vector3d along = (model.points[to].xyz - model.points[from].xyz).normalized();
    const Eigen::Vector2d beside = *project(bent_camera(), pose() * (sample.xyz + 1e-6 * along));
    EXPECT_NEAR((beside - sample.uv).normalized().dot(sample.normal), 0.0, 1e-3);
  }
}

TEST(TrackSamples, LeaveOutWhatFacesHide) {
  const MonoModel& model = box_record()->model;
  std::set<std::uint32_t> curves;
  for (const TrackSample& sample : samples_of(model, pose())) curves.insert(sample.curve);
  EXPECT_LT(curves.size(), model.edges.size());
  MonoModel wires = model;
  wires.faces.clear();
  std::set<std::uint32_t> all;
  for (const TrackSample& sample : samples_of(wires, pose())) all.insert(sample.curve);
  EXPECT_EQ(all.size(), model.edges.size());
}

TEST(TrackSamples, KeepToTheImageAndToTheirNumber) {
  const MonoModel& model = box_record()->model;
  RigidPose near = pose();
  near.t = {0.1, 0.0, 0.2};
  for (const TrackSample& sample : samples_of(model, near, {.most = 60})) {
    EXPECT_GE(sample.uv.minCoeff(), 3.0);
    EXPECT_LE(sample.uv.x(), 636.0);
    EXPECT_LE(sample.uv.y(), 476.0);
  }
  EXPECT_LE(samples_of(model, near, {.most = 60}).size(), 60U + model.edges.size());
  RigidPose behind = pose();
  behind.t.z() = -0.6;
  EXPECT_TRUE(samples_of(model, behind).empty());
}

TEST(TrackSamples, KnowTheCirclesOfAModel) {
  MonoModel disc;
  disc.circles.push_back({.normal = Eigen::Vector3d::UnitZ(), .radius_m = 0.05});
  disc.diameter_m = 0.1;
  const std::vector<TrackSample> samples = samples_of(disc, pose());
  ASSERT_GT(samples.size(), 20U);
  for (const TrackSample& sample : samples) EXPECT_NEAR(sample.xyz.norm(), 0.05, 1e-12);
}

TEST(TrackSamples, SayWhichEdgesRunBesideOthers) {
  MonoModel rails;
  for (const double y : {0.0, 0.003, 0.1}) {  // 3 px apart, and 100
    const auto first = static_cast<std::uint32_t>(rails.points.size());
    rails.points.push_back({.xyz = {-0.1, y, 0.0}});
    rails.points.push_back({.xyz = {0.1, y, 0.0}});
    rails.edges.push_back({first, first + 1});
  }
  rails.diameter_m = 0.2;
  const std::vector<TrackSample> samples =
      samples_of(rails, {Eigen::Matrix3d::Identity(), {0.0, 0.0, 0.6}});
  for (const TrackSample& sample : samples) EXPECT_EQ(sample.crowded, sample.curve < 2);
}

}  // namespace
}  // namespace landmarkdb
