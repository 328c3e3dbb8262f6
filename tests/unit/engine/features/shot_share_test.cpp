#include "engine/features/shot_share.hpp"

#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {
namespace {

constexpr float kRadius = 1.0F;

struct Points {
  std::vector<float> x, y, z, nx, ny, nz, squared;

  void add(const Eigen::Vector3f& p, const Eigen::Vector3f& n) {
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
    nx.push_back(n.x());
    ny.push_back(n.y());
    nz.push_back(n.z());
    squared.push_back(p.squaredNorm());
  }
};

struct Shares {
  std::size_t count = 0;
  std::array<std::vector<std::int32_t>, 5> places;  // own, cosine, shell, elevation, azimuth
  std::array<std::vector<float>, 5> weights;
};

Shares share(ShotShare kernel, Points points) {
  Shares result;
  result.count = points.x.size();
  const std::size_t size = (result.count + kShotLanes - 1) / kShotLanes * kShotLanes;
  for (auto* array : {&points.x, &points.y, &points.z, &points.nx, &points.ny, &points.nz}) {
    array->resize(size);
  }
  points.squared.resize(size);
  for (auto& array : result.places) array.resize(size);
  for (auto& array : result.weights) array.resize(size);
  const ShotPoints in{points.x.data(),
                      points.y.data(),
                      points.z.data(),
                      points.nx.data(),
                      points.ny.data(),
                      points.nz.data(),
                      points.squared.data()};
  ShotShares out{result.places[0].data(),
                 result.places[1].data(),
                 result.places[2].data(),
                 result.places[3].data(),
                 result.places[4].data(),
                 result.weights[0].data(),
                 result.weights[1].data(),
                 result.weights[2].data(),
                 result.weights[3].data(),
                 result.weights[4].data()};
  kernel(in, result.count, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, kRadius}, out);
  for (auto& array : result.places) array.resize(result.count);
  for (auto& array : result.weights) array.resize(result.count);
  return result;
}

Points random_points(std::size_t count) {
  Random random(count);
  Points points;
  while (points.x.size() < count) {
    const Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    if (p.norm() >= 1.0) continue;
    const Eigen::Vector3d n(random.normal(), random.normal(), random.normal());
    points.add(p.cast<float>(), n.normalized().cast<float>());
  }
  // Every border at once: axes, diagonals, poles, and normals along the z axis.
  for (const float a : {-0.5F, 0.0F, 0.5F}) {
    for (const float b : {-0.5F, 0.0F, 0.5F}) {
      for (const float c : {-0.5F, 0.0F, 0.5F}) {
        if (a == 0.0F && b == 0.0F && c == 0.0F) continue;
        points.add({a, b, c}, {0, 0, 1});
        points.add({a, b, c}, {0, 0, -1});
        points.add({a, b, c}, {1, 0, 0});
      }
    }
  }
  return points;
}

TEST(ShotShare, GivesTheSameBytesOnEveryInstructionSet) {
  if (shot_share("avx2") == nullptr) GTEST_SKIP() << "this machine has no AVX2";
  const Shares plain = share(shot_share("sse2"), random_points(1001));
  for (const char* name : {"avx2", "avx512"}) {
    if (shot_share(name) == nullptr) continue;
    const Shares wide = share(shot_share(name), random_points(1001));
    EXPECT_EQ(plain.places, wide.places) << name;
    EXPECT_EQ(plain.weights, wide.weights) << name;
  }
}

TEST(ShotShare, StaysInTheHistogramWithWeightsFromNothingToOne) {
  const Shares shares = share(shot_share(), random_points(5000));
  for (std::size_t i = 0; i < shares.count; ++i) {
    for (std::size_t along = 0; along < 5; ++along) {
      ASSERT_GE(shares.places[along][i], 0);
      ASSERT_LT(shares.places[along][i], static_cast<std::int32_t>(kShotLength));
      ASSERT_GE(shares.weights[along][i], 0.0F);
      ASSERT_LE(shares.weights[along][i], along == 0 ? 4.0F : 0.500001F);
    }
  }
}

// What a point gives to its own bin and to a neighbour along one axis adds up to one each, but for
// shells and halves on the side away from the border, which keep what they do not give.
TEST(ShotShare, GivesEachAxisOne) {
  const Shares shares = share(shot_share(), random_points(1000));
  for (std::size_t i = 0; i < 1000; ++i) {
    float total = 0.0F;
    for (const auto& weights : shares.weights) total += weights[i];
    EXPECT_LE(total, 4.00001F);
    EXPECT_GE(total, 3.0F);
    const bool gives_all = shares.weights[2][i] > 0.0F && shares.weights[3][i] > 0.0F;
    EXPECT_TRUE(!gives_all || std::abs(total - 4.0F) < 1e-5F) << total;
  }
}

TEST(ShotShare, PutsAPointWhereTheLayoutSays) {
  Points points;
  // Azimuth 22.5 degrees: the middle of octant 4. Outer shell, upper half, normal along z: bin 10.
  const float c = std::cos(0.3926991F);
  const float s = std::sin(0.3926991F);
  points.add({0.5F * c, 0.5F * s, 0.5F}, {0, 0, 1});
  // Azimuth -157.5 degrees: octant 0. Inner shell, lower half, normal across z: bin 5.
  points.add({-0.17F * c, -0.17F * s, -0.17F}, {1, 0, 0});
  const Shares shares = share(shot_share(), points);
  EXPECT_EQ(shares.places[0][0], (4 * 4 + 2 + 1) * 11 + 10);
  EXPECT_EQ(shares.places[0][1], 5);
  EXPECT_NEAR(shares.weights[4][0], 0.0F, 1e-6F);
  EXPECT_NEAR(shares.weights[1][0], 0.0F, 1e-6F);
  EXPECT_EQ(shares.places[2][0], (4 * 4 + 1) * 11 + 10);
  EXPECT_EQ(shares.places[3][0], (4 * 4 + 2) * 11 + 10);
}

TEST(ShotShare, KnowsNoOtherInstructionSet) { EXPECT_EQ(shot_share("mmx"), nullptr); }

}  // namespace
}  // namespace landmarkdb
