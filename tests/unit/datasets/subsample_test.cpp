#include "datasets/subsample.hpp"

#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

TEST(Choose, PicksExactlyAsManyAscendingAndDistinct) {
  for (const std::size_t wanted : {0U, 1U, 37U, 999U, 1000U}) {
    const std::vector<std::size_t> chosen = choose(1000, wanted, 5);
    EXPECT_EQ(chosen.size(), wanted);
    EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
    EXPECT_EQ(std::set<std::size_t>(chosen.begin(), chosen.end()).size(), wanted);
  }
}

TEST(Choose, FavoursNoNumber) {
  std::vector<int> times(20, 0);
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    for (const std::size_t i : choose(20, 5, seed)) ++times[i];
  }
  for (const int count : times) EXPECT_NEAR(count, 1000, 150);
}

TEST(Subsample, LeavesOutWhatIsNotFinite) {
  PointCloud cloud;
  cloud.width = 2;
  cloud.height = 2;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cloud.points = {{1, 0, 0}, {nan, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  const PointCloud all = subsample(cloud, 0, 1);
  EXPECT_EQ(all.size(), 3U);
  EXPECT_EQ(all.width, 0U);
  EXPECT_EQ(subsample(cloud, 2, 1).size(), 2U);
}

TEST(Subsample, RefusesMoreThanThereIs) {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}};
  EXPECT_THROW(subsample(cloud, 2, 1), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
