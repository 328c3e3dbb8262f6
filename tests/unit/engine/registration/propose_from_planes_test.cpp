#include "engine/registration/propose_from_planes.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "tests/support/plane_surface.hpp"

namespace landmarkdb {
namespace {

using testing::corner_of_room;
using testing::random_pose;
using testing::room;
using Surface = testing::PlaneSurface;

// How far the nearest proposal that turns as the truth does carries the centre from where it does.
double nearest_m(const std::vector<Proposal>& proposals,
                 const Eigen::Isometry3d& truth,
                 const Eigen::Vector3f& centre) {
  double nearest = 1e9;
  for (const Proposal& proposal : proposals) {
    const Eigen::Matrix3d R = proposal.R_target_source.cast<double>();
    if (rotation_angle_rad(truth.linear().transpose() * R) > 0.1) continue;
    const Eigen::Vector3d there =
        R * centre.cast<double>() + proposal.t_target_source.cast<double>();
    nearest = std::min(nearest, (there - truth * centre.cast<double>()).norm());
  }
  return nearest;
}

TEST(ProposeFromPlanes, HoldsTheTruePoseOfACornerTurnedAnyWay) {
  Random random(1);
  const Surface place = room();
  const auto target = place.layouts();
  ASSERT_EQ(target.size(), 1U);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Isometry3d truth = random_pose(random);
    const Surface query = corner_of_room().moved(truth.inverse());
    const auto source = query.layouts();
    ASSERT_EQ(source.size(), 1U);
    const auto proposals =
        propose_from_planes(target[0], source[0], query.centre(), std::nullopt, std::nullopt);
    EXPECT_LT(nearest_m(proposals, truth, query.centre()), 0.2) << i;
    for (const Proposal& proposal : proposals) {
      EXPECT_EQ(proposal.correspondence, kNoCorrespondence);
      EXPECT_NEAR(proposal.R_target_source.determinant(), 1.0F, 1e-4F);
    }
  }
}

TEST(ProposeFromPlanes, SweepsADirectionAlongWhichNothingIsFixed) {
  Surface query;  // floor and the long wall: free along x
  query.add({2, 0, 0}, {3, 0, 0}, {0, 2, 0});
  query.add({2, 0, 0}, {0, 0, 2}, {3, 0, 0});
  const auto proposals = propose_from_planes(
      room().layouts()[0], query.layouts()[0], query.centre(), std::nullopt, std::nullopt);
  EXPECT_LT(nearest_m(proposals, Eigen::Isometry3d::Identity(), query.centre()), 0.35);
}

TEST(ProposeFromPlanes, IsNotMovedByAPointFarOutAndEndsWhereOneIs) {
  Surface place = room();
  for (const float far : {1e7F, -1e7F}) {
    place.points.emplace_back(far, -far, far);
    place.normals.emplace_back(1.0F, 0.0F, 0.0F);
  }
  const Surface query = corner_of_room();
  const auto proposals = propose_from_planes(
      place.layouts()[0], query.layouts()[0], query.centre(), std::nullopt, std::nullopt);
  EXPECT_LT(nearest_m(proposals, Eigen::Isometry3d::Identity(), query.centre()), 0.2);
}

TEST(ProposeFromPlanes, ProposesNothingForAFloorAlone) {
  Surface query;
  query.add({2, 1, 0}, {3, 0, 0}, {0, 2, 0});
  query.add({2, 1, 0}, {0, 0, 0.1F}, {0.5F, 0, 0});
  const auto source = query.layouts();
  ASSERT_EQ(source.size(), 1U);
  EXPECT_TRUE(propose_from_planes(
                  room().layouts()[0], source[0], query.centre(), std::nullopt, std::nullopt)
                  .empty());
}

TEST(ProposeFromPlanes, KeepsToGravityAndThePrior) {
  Random random(3);
  const Eigen::Isometry3d truth = random_pose(random);
  const Surface query = corner_of_room().moved(truth.inverse());
  const auto target = room().layouts()[0];
  const auto source = query.layouts()[0];
  Gravity gravity;
  gravity.up_source = (truth.linear().transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  const auto upright = propose_from_planes(target, source, query.centre(), gravity, std::nullopt);
  EXPECT_LT(nearest_m(upright, truth, query.centre()), 0.2);
  for (const Proposal& proposal : upright) {
    EXPECT_GT((proposal.R_target_source * gravity.up_source).z(), 0.9999F);
  }
  PositionPrior prior;
  prior.centre = truth.translation().cast<float>();
  prior.radius_m = 0.5F;
  const auto near = propose_from_planes(target, source, query.centre(), gravity, prior);
  EXPECT_LT(nearest_m(near, truth, query.centre()), 0.2);
  EXPECT_LT(near.size(), upright.size());
  for (const Proposal& proposal : near) {
    EXPECT_LE((proposal.t_target_source - prior.centre).norm(), prior.radius_m);
  }
}

TEST(ProposeFromPlanes, IsBoundedInAHugeHall) {
  Surface hall;
  hall.add({0, 0, 0}, {60, 0, 0}, {0, 40, 0});
  for (float x = 5.0F; x < 60.0F; x += 5.0F) {
    for (float y = 5.0F; y < 40.0F; y += 5.0F) hall.add({x, y, 0}, {0, 0.4F, 0}, {0, 0, 3});
  }
  for (float y = 5.0F; y < 40.0F; y += 5.0F) hall.add({0, y, 0}, {0, 0, 3}, {60, 0, 0});
  const Surface query = corner_of_room();
  const auto proposals = propose_from_planes(
      hall.layouts()[0], query.layouts()[0], query.centre(), std::nullopt, std::nullopt);
  EXPECT_FALSE(proposals.empty());
  EXPECT_LT(proposals.size(), 24U * 48U * 48U * 14U);
}

}  // namespace
}  // namespace landmarkdb
