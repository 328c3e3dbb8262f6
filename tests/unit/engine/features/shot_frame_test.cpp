#include <vector>

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "engine/features/shot_kernel.hpp"

namespace landmarkdb {
namespace {

Neighbourhood neighbourhood(const std::vector<Eigen::Vector3f>& offsets) {
  Neighbourhood points;
  points.reserve(offsets.size());
  for (const Eigen::Vector3f& p : offsets) {
    points.x[points.count] = p.x();
    points.y[points.count] = p.y();
    points.z[points.count] = p.z();
    points.nz[points.count] = 1.0F;
    points.squared_m2[points.count] = p.squaredNorm();
    ++points.count;
  }
  return points;
}

// A patch longer along `u` than along `v`, flat across w; more of it ahead along u, all bent to +w.
std::vector<Eigen::Vector3f> patch(const Eigen::Vector3f& u,
                                   const Eigen::Vector3f& v,
                                   const Eigen::Vector3f& w) {
  Random random(1);
  std::vector<Eigen::Vector3f> offsets;
  for (int i = 0; i < 200; ++i) {
    const auto a = static_cast<float>(random.uniform(-0.3, 0.8));
    const auto b = static_cast<float>(random.uniform(-0.3, 0.3));
    offsets.push_back(a * u + b * v + 0.1F * (a * a + b * b) * w);
  }
  return offsets;
}

TEST(ShotFrame, LiesAlongThePatchWithItsSignsTowardsMost) {
  const Eigen::Vector3f u = Eigen::Vector3f(1, 2, -1).normalized();
  const Eigen::Vector3f v = u.cross(Eigen::Vector3f(0.3F, 0, 1)).normalized();
  const Eigen::Vector3f w = u.cross(v);
  Eigen::Matrix3f R;
  ASSERT_TRUE(shot_frame(neighbourhood(patch(u, v, w)), 1.0F, R));
  EXPECT_GT(R.col(0).dot(u), 0.98F);
  EXPECT_GT(R.col(2).dot(w), 0.98F);
  EXPECT_NEAR(R.determinant(), 1.0F, 1e-6F);
  ASSERT_TRUE(shot_frame(neighbourhood(patch(-u, v, -w)), 1.0F, R));
  EXPECT_GT(R.col(0).dot(-u), 0.98F);
  EXPECT_GT(R.col(2).dot(-w), 0.98F);
}

// Three points ahead and three behind: the five of middle distance decide, of which three are
// ahead.
TEST(ShotFrame, LetsTheMiddlePointsDecideATie) {
  const std::vector<Eigen::Vector3f> offsets = {{0.2F, 0.01F, 0.001F},
                                                {-0.3F, 0.02F, 0.002F},
                                                {0.4F, -0.01F, 0.001F},
                                                {-0.5F, -0.02F, 0.003F},
                                                {0.6F, 0.01F, 0.002F},
                                                {-0.1F, 0.03F, 0.001F}};
  Eigen::Matrix3f R;
  ASSERT_TRUE(shot_frame(neighbourhood(offsets), 1.0F, R));
  EXPECT_GT(R(0, 0), 0.9F);
  std::vector<Eigen::Vector3f> opposite;
  for (const Eigen::Vector3f& p : offsets) opposite.push_back(-p);
  ASSERT_TRUE(shot_frame(neighbourhood(opposite), 1.0F, R));
  EXPECT_LT(R(0, 0), -0.9F);
}

TEST(ShotFrame, IsNotDefinedByFewerThanFivePoints) {
  std::vector<Eigen::Vector3f> offsets = {
      {0.1F, 0, 0}, {0, 0.1F, 0}, {0, 0, 0.1F}, {0.1F, 0.1F, 0}, {0, 0.2F, 0.1F}};
  Eigen::Matrix3f R;
  EXPECT_TRUE(shot_frame(neighbourhood(offsets), 1.0F, R));
  offsets.pop_back();
  EXPECT_FALSE(shot_frame(neighbourhood(offsets), 1.0F, R));
  EXPECT_FALSE(shot_frame({}, 1.0F, R));
}

}  // namespace
}  // namespace landmarkdb
