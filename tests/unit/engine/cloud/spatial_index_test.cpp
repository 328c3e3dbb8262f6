#include "engine/cloud/spatial_index.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.emplace_back(p.cast<float>());
  }
  return points;
}

// Every point with its distance, nearest first, ties by index.
std::vector<Neighbour> brute_force(const std::vector<Eigen::Vector3f>& points,
                                   const Eigen::Vector3f& query) {
  std::vector<Neighbour> all;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    float squared = 0.0F;
    for (int axis = 0; axis < 3; ++axis) {
      const float d = query[axis] - points[i][axis];
      squared += d * d;
    }
    all.push_back({i, squared});
  }
  std::sort(all.begin(), all.end(), [](const Neighbour& a, const Neighbour& b) {
    return std::pair(a.squared_distance_m2, a.index) < std::pair(b.squared_distance_m2, b.index);
  });
  return all;
}

void expect_same(const std::vector<Neighbour>& found, std::span<const Neighbour> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_EQ(found[k].index, expected[k].index) << k;
    EXPECT_EQ(found[k].squared_distance_m2, expected[k].squared_distance_m2) << k;
  }
}

TEST(SpatialIndex, AgreesWithBruteForce) {
  const std::vector<Eigen::Vector3f> points = random_points(2000, 1);
  const SpatialIndex index(points);
  std::vector<Neighbour> found;
  for (const Eigen::Vector3f& query : random_points(100, 2)) {
    const std::vector<Neighbour> all = brute_force(points, query);
    index.nearest(query, 10, found);
    expect_same(found, std::span(all).first(10));
    constexpr float kRadius = 0.2F;
    index.within(query, kRadius, found);
    const auto inside = std::count_if(all.begin(), all.end(), [](const Neighbour& neighbour) {
      return neighbour.squared_distance_m2 <= kRadius * kRadius;
    });
    expect_same(found, std::span(all).first(static_cast<std::size_t>(inside)));
  }
}

TEST(SpatialIndex, BreaksTiesByTheLowerIndex) {
  // A grid of whole numbers, twice: every distance occurs many times.
  std::vector<Eigen::Vector3f> points;
  for (int copy = 0; copy < 2; ++copy) {
    for (int i = 0; i < 1000; ++i) {
      points.emplace_back(
          static_cast<float>(i % 10), static_cast<float>(i / 10 % 10), static_cast<float>(i / 100));
    }
  }
  const SpatialIndex index(points);
  std::vector<Neighbour> found;
  for (const Eigen::Vector3f& query : {Eigen::Vector3f(5, 5, 5), Eigen::Vector3f(0.5F, 0.5F, 9)}) {
    const std::vector<Neighbour> all = brute_force(points, query);
    for (const std::size_t k : {1U, 3U, 9U, 20U}) {
      index.nearest(query, k, found);
      expect_same(found, std::span(all).first(k));
    }
  }
}

TEST(SpatialIndex, GivesAllPointsWhenAskedForMore) {
  const std::vector<Eigen::Vector3f> points = random_points(5, 3);
  const SpatialIndex index(points);
  std::vector<Neighbour> found;
  index.nearest(Eigen::Vector3f::Zero(), 100, found);
  EXPECT_EQ(found.size(), 5U);
  index.nearest(Eigen::Vector3f::Zero(), 0, found);
  EXPECT_TRUE(found.empty());
}

TEST(SpatialIndex, HoldsNothingAndManyOfTheSame) {
  std::vector<Neighbour> found{{1, 1.0F}};
  const std::vector<Eigen::Vector3f> none;
  SpatialIndex(none).nearest(Eigen::Vector3f::Zero(), 3, found);
  EXPECT_TRUE(found.empty());
  SpatialIndex(none).within(Eigen::Vector3f::Zero(), 1.0F, found);
  EXPECT_TRUE(found.empty());
  const std::vector<Eigen::Vector3f> same(10'000, Eigen::Vector3f::Ones());
  SpatialIndex(same).within(Eigen::Vector3f::Ones(), 0.0F, found);
  EXPECT_EQ(found.size(), same.size());
}

}  // namespace
}  // namespace landmarkdb
