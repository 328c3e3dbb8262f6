#include "engine/cloud/moment_sums.hpp"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kPoints = 5 * kMomentLanes;
constexpr float kCentre[3] = {1.0F, -2.0F, 0.5F};
constexpr float kRadius = 0.8F;

struct Points {
  std::vector<float> x, y, z;
  explicit Points(std::uint64_t seed) {
    Random random(seed);
    for (std::size_t i = 0; i < kPoints; ++i) {
      x.push_back(kCentre[0] + static_cast<float>(random.uniform(-1.0, 1.0)));
      y.push_back(kCentre[1] + static_cast<float>(random.uniform(-1.0, 1.0)));
      z.push_back(kCentre[2] + static_cast<float>(random.uniform(-1.0, 1.0)));
    }
  }
  Moments added(MomentSums sums) const {
    return sums(x.data(), y.data(), z.data(), kPoints, kCentre, kRadius * kRadius);
  }
};

TEST(MomentSums, AddsUpWhatIsNear) {
  const Points points(1);
  double count = 0.0;
  double xy = 0.0;
  double z = 0.0;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double d[3] = {static_cast<double>(points.x[i]) - kCentre[0],
                         static_cast<double>(points.y[i]) - kCentre[1],
                         static_cast<double>(points.z[i]) - kCentre[2]};
    if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] >= kRadius * kRadius) continue;
    count += 1.0;
    z += d[2];
    xy += d[0] * d[1];
  }
  const Moments moments = points.added(moment_sums());
  ASSERT_GT(count, 10.0);
  ASSERT_LT(count, static_cast<double>(kPoints));
  EXPECT_EQ(moments.count, static_cast<float>(count));
  EXPECT_NEAR(moments.sum[2], z, 1e-4);
  EXPECT_NEAR(moments.products[1], xy, 1e-4);
}

TEST(MomentSums, TakesNoneOfWhatIsFarAway) {
  const std::vector<float> far(kMomentLanes, 1e30F);
  const Moments moments =
      moment_sums()(far.data(), far.data(), far.data(), far.size(), kCentre, 4.0F);
  EXPECT_EQ(moments.count, 0.0F);
  EXPECT_EQ(moments.products[5], 0.0F);
}

TEST(MomentSums, IsTheSameOnAllInstructionSets) {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Points points(seed);
    const Moments baseline = points.added(moment_sums("sse2"));
    for (const char* name : {"avx2", "avx512"}) {
      const MomentSums other = moment_sums(name);
      if (other == nullptr) continue;
      const Moments sums = points.added(other);
      EXPECT_EQ(std::memcmp(&sums, &baseline, sizeof sums), 0) << name;
    }
  }
}

}  // namespace
}  // namespace landmarkdb
