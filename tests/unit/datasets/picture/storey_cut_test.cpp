#include "datasets/picture/storey_cut.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

// Floor and ceiling of two storeys, 12 x 5 m, turned by `angle`.
std::vector<Eigen::Vector3f> storeys(double angle) {
  Random random(1);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 8000; ++i) {
    const double x = random.uniform(0, 12);
    const double y = random.uniform(0, 5);
    const double z = std::array<double, 4>{0.0, 2.6, 3.0, 5.6}[static_cast<std::size_t>(i % 4)];
    points.emplace_back(Eigen::Vector3d(std::cos(angle) * x - std::sin(angle) * y,
                                        std::sin(angle) * x + std::cos(angle) * y,
                                        z)
                            .cast<float>());
  }
  return points;
}

TEST(FindStorey, CutsBetweenFloorAndCeilingOfTheSensorsStorey) {
  const StoreyCut lower = find_storey(storeys(0.0), {6, 2.5, 1.5});
  EXPECT_NEAR(lower.floor_m, -0.15, 0.06);
  EXPECT_LT(lower.top_m, 2.55F);
  EXPECT_GT(lower.top_m, 2.0F);
  const StoreyCut upper = find_storey(storeys(0.0), {6, 2.5, 4.5});
  EXPECT_NEAR(upper.floor_m, 2.85, 0.06);
}

TEST(FindStorey, GuessesWhereThereIsNothing) {
  const StoreyCut cut = find_storey({}, {0, 0, 1.5});
  EXPECT_LT(cut.floor_m, 0.1F);
  EXPECT_GT(cut.top_m, 1.5F);
}

TEST(Straighten, LaysTheLongSideAlongX) {
  for (const double angle : {-1.2, -0.4, 0.0, 0.7, 1.4}) {
    const double turned = straighten_rad(storeys(angle)) + angle;
    EXPECT_NEAR(std::sin(turned), 0.0, 0.02) << angle;
  }
}

TEST(Straighten, LeavesNothingAsItIs) { EXPECT_EQ(straighten_rad({}), 0.0); }

TEST(DropStrays, TakesOutWhatHangsInTheAirOfADenseCloudOnly) {
  std::vector<Eigen::Vector3f> points;
  Random random(1);
  for (int i = 0; i < 20'000; ++i) {
    points.emplace_back(
        Eigen::Vector3d(random.uniform(0, 3), random.uniform(0, 3), 0.0).cast<float>());
  }
  points.emplace_back(1.5F, 1.5F, 1.5F);
  drop_strays(points);
  EXPECT_EQ(points.size(), 20'000U);
  std::vector<Eigen::Vector3f> sparse = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  drop_strays(sparse);
  EXPECT_EQ(sparse.size(), 3U);
}

}  // namespace
}  // namespace landmarkdb::datasets
