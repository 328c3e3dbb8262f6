#include "datasets/sensor_poses.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

class PosesIn : public ::testing::TestWithParam<PlaceType> {
 protected:
  Place place_ = make_place({.type = GetParam(), .seed = 9, .size = 0.8, .floors = 1});
};

// Rays of the test's own: not the fan that the sampler looks along.
TEST_P(PosesIn, StandInTheOpenAndNotInThings) {
  Random random(1);
  for (const Eigen::Isometry3d& T : sample_camera_poses(place_, 15, 3)) {
    int inside = 0;
    int near = 0;
    for (int i = 0; i < 300; ++i) {
      const Eigen::Vector3d direction =
          Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
      const auto hit =
          place_.caster->first_hit(T.translation().cast<float>(), direction.cast<float>(), 200.0F);
      ASSERT_TRUE(hit) << "the building has a hole";
      inside += hit->front_face ? 0 : 1;
      near += hit->distance_m < 0.4F ? 1 : 0;
    }
    EXPECT_LE(inside, 2);  // seams of things that touch
    EXPECT_LE(near, 6);    // the thin ones the fan's rays pass by
  }
}

TEST_P(PosesIn, HoldTheCameraUprightAtEyeHeight) {
  for (const Eigen::Isometry3d& T : sample_camera_poses(place_, 15, 4)) {
    EXPECT_GE(T.translation().z(), 0.8 - 1e-9);
    EXPECT_LE(T.translation().z(), 1.8 + 1e-9);
    EXPECT_NEAR(T.linear().determinant(), 1.0, 1e-9);
    EXPECT_LT((T.linear().transpose() * T.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-9);
    EXPECT_LT(T.linear().col(1).z(), -0.8) << "the camera's y axis points down";
  }
}

INSTANTIATE_TEST_SUITE_P(All,
                         PosesIn,
                         ::testing::ValuesIn(all_place_types().begin(), all_place_types().end()),
                         [](const auto& type) { return std::string(place_type_name(type.param)); });

TEST(SampleCameraPoses, DependOnTheSeedAndTheNumberOnly) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.7});
  const auto few = sample_camera_poses(place, 3, 11);
  const auto many = sample_camera_poses(place, 6, 11);
  const auto others = sample_camera_poses(place, 3, 12);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(few[i].matrix(), many[i].matrix());
    EXPECT_NE(few[i].matrix(), others[i].matrix());
  }
}

TEST(SampleCameraPoses, TurnAnyWayWhenAsked) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.7});
  int upside_down = 0;
  for (const Eigen::Isometry3d& T : sample_camera_poses(place, 40, 1, {.any_roll = true})) {
    if (T.linear().col(1).z() > 0.0) ++upside_down;
  }
  EXPECT_GT(upside_down, 8);
  EXPECT_LT(upside_down, 32);
}

TEST(SampleCameraPoses, StayOnTheStoreyAskedFor) {
  const Place place =
      make_place({.type = PlaceType::kCorridor, .seed = 1, .size = 0.5, .floors = 2});
  for (const Eigen::Isometry3d& T : sample_upright_poses(place, 10, 1, {.floor = 1})) {
    EXPECT_GT(T.translation().z(), place.floor_height_m);
  }
  EXPECT_THROW(sample_upright_poses(place, 1, 1, {.floor = 2}), Error);
}

TEST(SampleCameraPoses, GiveUpWhereNobodyCanStand) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.5});
  EXPECT_THROW(sample_camera_poses(place, 1, 1, {.clearance_m = 30.0}), Error);
}

TEST(IsFree, IsFalseInsideASolidAndOutsideTheBuilding) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.5});
  EXPECT_FALSE(is_free(*place.caster, {500.0, 0.0, 1.5}, 0.1));
  TriangleMesh mesh;
  add_box(mesh, at(0, 0), {4, 4, 4});
  EXPECT_FALSE(is_free(RayCaster(mesh), {0, 0, 2}, 0.1));
}

}  // namespace
}  // namespace landmarkdb::datasets
