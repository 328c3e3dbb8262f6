#include "engine/features/iss_keypoints.hpp"

#include <gmock/gmock.h>

#include "tests/unit/engine/features/feature_clouds.hpp"

namespace landmarkdb {
namespace {

using testing::add_point;

constexpr IssOptions kOptions{.salient_radius_m = 0.24, .nms_radius_m = 0.16};

TEST(IssKeypoints, TakesTheMostSalientWithinItsReach) {
  const PreparedCloud cloud = testing::corner_room(1);
  const Keypoints found = iss_keypoints(cloud, kOptions, {});
  ASSERT_GT(found.size(), 2U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t j = i + 1; j < found.size(); ++j) {
      EXPECT_GE((cloud.points[found.index[i]] - cloud.points[found.index[j]]).norm(), 0.16F);
    }
  }
}

TEST(IssKeypoints, FindsNothingWhereNothingStandsOut) {
  PreparedCloud line;
  PreparedCloud place;
  for (int i = 0; i < 100; ++i) {
    add_point(line, {0.02 * i, 0, 0}, {0, 0, 1});
    add_point(place, {1, 1, 1}, {0, 0, 1});
  }
  EXPECT_EQ(iss_keypoints(line, kOptions, {}).size(), 0U);
  EXPECT_EQ(iss_keypoints(place, kOptions, {}).size(), 0U);
  EXPECT_EQ(iss_keypoints({}, kOptions, {}).size(), 0U);
}

TEST(IssKeypoints, NeedsNeighbours) {
  const PreparedCloud cloud = testing::corner_room(2);
  IssOptions options = kOptions;
  options.min_neighbours = 100000;
  EXPECT_EQ(iss_keypoints(cloud, options, {}).size(), 0U);
}

}  // namespace
}  // namespace landmarkdb
