#include "engine/geometry/packed_rotation.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

double angle_between(const Eigen::Matrix3f& a, const Eigen::Matrix3f& b) {
  return Eigen::AngleAxisd((a.transpose() * b).cast<double>()).angle();
}

TEST(PackedRotation, ComesBackWithinATenthOfAMilliradian) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Quaternionf q(static_cast<float>(random.normal()),
                               static_cast<float>(random.normal()),
                               static_cast<float>(random.normal()),
                               static_cast<float>(random.normal()));
    const Eigen::Matrix3f R = q.normalized().toRotationMatrix();
    const Eigen::Matrix3f back = unpack_rotation(pack_rotation(R));
    EXPECT_LT(angle_between(R, back), 1e-4) << i;
    EXPECT_LT((back.transpose() * back - Eigen::Matrix3f::Identity()).cwiseAbs().maxCoeff(), 1e-6F);
  }
}

TEST(PackedRotation, HoldsHalfTurnsAndNone) {
  for (const Eigen::Vector3f& axis : {Eigen::Vector3f::UnitX().eval(),
                                      Eigen::Vector3f::UnitY().eval(),
                                      Eigen::Vector3f::UnitZ().eval(),
                                      Eigen::Vector3f(1, -1, 1).normalized()}) {
    const Eigen::Matrix3f R = Eigen::AngleAxisf(3.14159265F, axis).toRotationMatrix();
    EXPECT_LT(angle_between(R, unpack_rotation(pack_rotation(R))), 5e-4);
  }
  const std::vector<Eigen::Matrix3f> none{Eigen::Matrix3f::Identity()};
  const std::vector<PackedRotation> packed = pack_rotations(none);
  ASSERT_EQ(packed.size(), 1U);
  EXPECT_EQ(unpack_rotation(packed[0]), none[0]);
  EXPECT_EQ(unpack_rotation({}), none[0]) << "bytes that are no rotation";
}

}  // namespace
}  // namespace landmarkdb
