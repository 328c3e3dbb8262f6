#include "engine/mono/four_screen.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/mono/four_pose.hpp"
#include "engine/mono/line_of_sight.hpp"

namespace landmarkdb {
namespace {

constexpr double kSigma = 1.0 / 600.0;
constexpr double kMostSigmas = 1.6;
constexpr std::array<std::uint16_t, 4> kIds{0, 1, 2, 3};

// Within 0.2 m.
std::vector<PosePoint> some_four(Random& random) {
  std::vector<PosePoint> points(4);
  for (PosePoint& point : points) {
    for (double& x : point.xyz) x = random.uniform(-0.1, 0.1);
  }
  return points;
}

// As it is seen from 0.4 to 2 m away, a pixel or so off.
TurnedFour some_view(const std::vector<PosePoint>& four, double noise, Random& random) {
  const Eigen::Vector4d q(random.normal(), random.normal(), random.normal(), random.normal());
  const Eigen::Matrix3d R = Eigen::Quaterniond(q.normalized()).toRotationMatrix();
  const Eigen::Vector3d t(
      random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(0.4, 2.0));
  std::array<Eigen::Vector2d, 4> rays;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector3d X = R * four[k].xyz + t;
    rays[k] = X.head<2>() / X.z() + noise * Eigen::Vector2d(random.normal(), random.normal());
  }
  const Eigen::Matrix3d Q = turn_into_sight(rays);
  return {Q, turned(Q, rays)};
}

double sigmas_of(const std::vector<PosePoint>& four, const TurnedFour& seen) {
  FourPose pose(four, kIds, seen);
  pose.correct();
  return pose.sigmas(kSigma);
}

bool passes(const std::vector<PosePoint>& four, const TurnedFour& seen) {
  FourLanes lanes;
  constexpr std::size_t kLane = 5;
  lanes.set(kLane, {&four[0].xyz, &four[1].xyz, &four[2].xyz, &four[3].xyz});
  std::array<std::uint8_t, FourLanes::kLanes> result{};
  screen_fours(lanes, seen.rays, kMostSigmas, kSigma, result);
  return result[kLane] != 0;
}

TEST(ScreenFours, PassesAllWithinTheBoundAndFewBeyond) {
  Random random(1);
  std::size_t within = 0, beyond = 0, passed = 0;
  for (int round = 0; round < 20000; ++round) {
    const std::vector<PosePoint> four = some_four(random);
    const TurnedFour seen = some_view(four, random.uniform(0.0, 0.02), random);
    const double sigmas = sigmas_of(four, seen);
    if (sigmas <= kMostSigmas) {
      ++within;
      EXPECT_TRUE(passes(four, seen)) << sigmas;
    } else if (sigmas > 1.1 * kMostSigmas) {
      ++beyond;
      passed += passes(four, seen) ? 1 : 0;
    }
  }
  EXPECT_GT(within, 1000U);
  EXPECT_GT(beyond, 1000U);
  EXPECT_LT(passed * 200, beyond);
}

TEST(ScreenFours, PassesWhatIsNoNumber) {
  Random random(2);
  const std::vector<PosePoint> four = some_four(random);
  TurnedFour seen = some_view(four, 0.0, random);
  seen.rays[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(passes(four, seen)) << "it is the exact test's to judge";
}

TEST(ScreenFours, IsTheSameOnAllInstructionSets) {
  Random random(3);
  FourLanes lanes;
  for (std::array<float, FourLanes::kLanes>& row : lanes.differences) {
    for (float& x : row) x = static_cast<float>(random.uniform(-0.1, 0.1));
  }
  for (int round = 0; round < 200; ++round) {
    std::array<float, 8> rays;
    for (float& x : rays) x = static_cast<float>(random.uniform(-0.1, 0.1));
    const auto passes_by = [&](const char* name) {
      std::array<std::uint8_t, FourLanes::kLanes> passes{};
      screen_kernel(name)(lanes, rays.data(), 1e-3F, passes.data());
      return passes;
    };
    for (const char* name : {"avx2", "avx512"}) {
      if (screen_kernel(name) != nullptr) {
        EXPECT_EQ(passes_by(name), passes_by("sse2")) << name;
      }
    }
  }
  EXPECT_EQ(screen_kernel("none"), nullptr);
}

}  // namespace
}  // namespace landmarkdb
