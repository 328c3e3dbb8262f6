#include "engine/mono/image_fours.hpp"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

Camera camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 320.0;
  camera.cy = 240.0;
  return camera;
}

ImageView view(std::size_t points, std::vector<std::array<std::uint32_t, 2>> links) {
  ImageFeatures features;
  features.width = 640;
  features.height = 480;
  for (std::size_t i = 0; i < points; ++i) {
    ImageFeature feature;
    feature.uv = {40.0 + 50.0 * static_cast<double>(i % 10), 60.0 + 3.0 * static_cast<double>(i)};
    features.points.push_back(feature);
  }
  for (const auto& link : links) features.links.push_back({link[0], link[1]});
  return {features, camera(), 8.0};
}

TEST(ImageFours, TakesAPathInItsOrder) {
  const ImageFours found = linked_fours(view(5, {{0, 3}, {3, 1}, {1, 4}}), 100);
  ASSERT_EQ(found.fours.size(), 1U);
  std::array<std::uint16_t, 4> ids = found.fours[0].ids;
  if (ids[0] > ids[3]) std::reverse(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::array<std::uint16_t, 4>{0, 3, 1, 4}));
  EXPECT_EQ(found.fours[0].shape, FourShape::kPath);
  EXPECT_FALSE(found.cut_short);
}

TEST(ImageFours, TakesAStarWithItsMiddleFirst) {
  const ImageFours found = linked_fours(view(4, {{2, 0}, {2, 1}, {2, 3}}), 100);
  ASSERT_EQ(found.fours.size(), 1U);
  EXPECT_EQ(found.fours[0].shape, FourShape::kStar);
  EXPECT_EQ(found.fours[0].ids[0], 2);
}

TEST(ImageFours, TakesEachFourOnceHoweverManyLinksItHas) {
  const ImageFours found =
      linked_fours(view(5, {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}, {3, 4}}), 1000);
  std::set<std::array<std::uint16_t, 4>> sets;
  for (const ImageFour& four : found.fours) {
    std::array<std::uint16_t, 4> ids = four.ids;
    std::sort(ids.begin(), ids.end());
    EXPECT_TRUE(sets.insert(ids).second);
  }
  EXPECT_EQ(sets.size(), 4U);  // the four corners, and the fifth with two of three at corner 3
}

TEST(ImageFours, TakesNoneWhereLessThanThreeLinksMeet) {
  EXPECT_TRUE(linked_fours(view(6, {{0, 1}, {1, 2}, {3, 4}}), 100).fours.empty());
  EXPECT_TRUE(linked_fours(view(0, {}), 100).fours.empty());
}

TEST(ImageFours, SaysWhenItTookASampleAndTakesTheSameOneAgain) {
  std::vector<std::array<std::uint32_t, 2>> links;
  for (std::uint32_t a = 0; a < 30; ++a) {
    for (std::uint32_t b = 0; b < a; ++b) links.push_back({a, b});
  }
  const ImageView image = view(30, links);
  const ImageFours one = linked_fours(image, 500), other = linked_fours(image, 500);
  EXPECT_TRUE(one.cut_short);
  EXPECT_LT(one.fours.size(), 700U);
  EXPECT_GT(one.fours.size(), 200U);
  ASSERT_EQ(one.fours.size(), other.fours.size());
  for (std::size_t i = 0; i < one.fours.size(); ++i)
    EXPECT_EQ(one.fours[i].ids, other.fours[i].ids);
}

}  // namespace
}  // namespace landmarkdb
