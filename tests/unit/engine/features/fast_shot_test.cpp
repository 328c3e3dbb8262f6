#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <gmock/gmock.h>

#include "engine/features/describe_shot.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::corner_room;
using testing::every;

float largest_difference(std::span<const float> a, std::span<const float> b) {
  float largest = 0.0F;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

// The share of rows that agree with PCL's, frame and histogram.
double share_like_pcl(const PreparedCloud& cloud, const Keypoints& keypoints, double radius_m) {
  const DescriptorSet ours = describe_shot(cloud, keypoints, radius_m, {}, ShotMethod::kFast);
  const DescriptorSet pcl = describe_shot(cloud, keypoints, radius_m, {}, ShotMethod::kPcl);
  EXPECT_EQ(ours.size(), pcl.size());
  EXPECT_EQ(ours.dropped, pcl.dropped);
  if (ours.size() != pcl.size() || ours.size() == 0) return 0.0;
  std::size_t same = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const bool frame = (ours.frames[i] - pcl.frames[i]).norm() < 1e-4F;
    if (frame && largest_difference(ours.row(i), pcl.row(i)) < 1e-4F) ++same;
  }
  return static_cast<double>(same) / static_cast<double>(ours.size());
}

// Points within rounding of a bin's border may fall to either side, and then the row differs.
TEST(FastShot, EqualsPclsFramesAndDescriptors) {
  for (const double radius_m : {0.12, 0.3, 0.8}) {
    const PreparedCloud cloud = corner_room(1);
    EXPECT_GE(share_like_pcl(cloud, every(cloud, 29), radius_m), 0.98) << radius_m;
  }
}

TEST(FastShot, EqualsPclsFarFromZeroAndUpsideDown) {
  PreparedCloud cloud = corner_room(2);
  const Eigen::Matrix3f R = rotation_from_vector(Eigen::Vector3d(2.1, -0.7, 1.3)).cast<float>();
  for (Eigen::Vector3f& p : cloud.points) p = R * p + Eigen::Vector3f(200, -300, 50);
  for (Eigen::Vector3f& n : cloud.normals) n = R * n;
  EXPECT_GE(share_like_pcl(cloud, every(cloud, 13), 0.3), 0.98);
}

TEST(FastShot, EqualsPclsWhereFewPointsLieInReach) {
  // Five to fifteen neighbours, and ties of the signs in plenty.
  const PreparedCloud cloud = corner_room(3);
  EXPECT_GE(share_like_pcl(cloud, every(cloud, 7), 0.07), 0.95);
}

TEST(FastShot, LeavesDuplicatesOfTheKeypointOut) {
  PreparedCloud cloud = corner_room(4);
  for (int i = 0; i < 3; ++i) {
    cloud.points.push_back(cloud.points[100]);
    cloud.normals.push_back(cloud.normals[100]);
  }
  Keypoints keypoints;
  keypoints.index = {100};
  EXPECT_EQ(share_like_pcl(cloud, keypoints, 0.3), 1.0);
}

}  // namespace
}  // namespace landmarkdb
