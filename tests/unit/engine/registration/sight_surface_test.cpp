#include "engine/registration/sight_surface.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t count) {
  Random random(count);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(
        Eigen::Vector3d(random.uniform(-9, 9), random.uniform(-3, 3), random.uniform(0, 2))
            .cast<float>());
  }
  return points;
}

// In one order, whatever it was.
std::vector<std::array<float, 3>> sorted(std::span<const Eigen::Vector3f> points) {
  std::vector<std::array<float, 3>> values;
  for (const Eigen::Vector3f& p : points) values.push_back({p.x(), p.y(), p.z()});
  std::sort(values.begin(), values.end());
  return values;
}

TEST(SightSurface, KeepsEachPointInOneBlockThatHoldsIt) {
  for (const std::size_t count : {1U, 128U, 129U, 5000U}) {
    const std::vector<Eigen::Vector3f> points = random_points(count);
    const SightSurface surface(points);
    EXPECT_EQ(sorted(surface.points()), sorted(points));
    EXPECT_FALSE(surface.has_normals());
    std::uint32_t next = 0;
    for (const SightSurface::Block& block : surface.blocks()) {
      EXPECT_EQ(block.begin, next);
      EXPECT_GT(block.end, block.begin);
      next = block.end;
      for (std::uint32_t i = block.begin; i < block.end; ++i) {
        EXPECT_LE((surface.points()[i] - block.centre).norm(), block.radius_m);
      }
    }
    EXPECT_EQ(next, count);
  }
}

TEST(SightSurface, BlocksAreSmallAgainstTheWhole) {
  const SightSurface surface(random_points(20'000));
  for (const SightSurface::Block& block : surface.blocks()) EXPECT_LT(block.radius_m, 2.0F);
}

TEST(SightSurface, IsTheSameForAnyNumberOfThreads) {
  const std::vector<Eigen::Vector3f> points = random_points(5000);
  const SightSurface alone(points, points, 0.1, 1);
  for (const int threads : {2, 3, 8}) {
    const SightSurface together(points, points, 0.1, threads);
    EXPECT_TRUE(std::ranges::equal(together.points(), alone.points())) << threads;
    EXPECT_TRUE(std::ranges::equal(together.normals(), alone.normals())) << threads;
    EXPECT_TRUE(std::ranges::equal(together.blocks(),
                                   alone.blocks(),
                                   [](const auto& a, const auto& b) {
                                     return a.begin == b.begin && a.end == b.end &&
                                            a.spread_end == b.spread_end && a.centre == b.centre &&
                                            a.radius_m == b.radius_m;
                                   }))
        << threads;
  }
}

TEST(SightSurface, KeepsTheNormalsBesideTheirPoints) {
  const std::vector<Eigen::Vector3f> points = random_points(700);
  std::vector<Eigen::Vector3f> normals;
  for (const Eigen::Vector3f& p : points) normals.push_back(-p);
  const SightSurface surface(points, normals);
  ASSERT_TRUE(surface.has_normals());
  for (std::size_t i = 0; i < surface.size(); ++i) {
    EXPECT_EQ(surface.normals()[i], Eigen::Vector3f(-surface.points()[i]));
  }
}

TEST(SightSurface, PutsPointsTwiceAsFarApartFirst) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 2500; ++i) {
    points.emplace_back(
        0.05F * static_cast<float>(i % 50), 0.05F * static_cast<float>(i / 50), 0.0F);
  }
  const SightSurface surface(points, {}, 0.05);
  EXPECT_EQ(sorted(surface.points()), sorted(points));
  for (const SightSurface::Block& block : surface.blocks()) {
    ASSERT_GT(block.spread_end, block.begin);
    ASSERT_LE(block.spread_end, block.end);
    for (std::uint32_t i = block.begin; i < block.end; ++i) {
      float nearest = 1.0F;
      for (std::uint32_t k = block.begin; k < block.spread_end; ++k) {
        if (k != i) nearest = std::min(nearest, (surface.points()[i] - surface.points()[k]).norm());
      }
      if (i < block.spread_end) {
        EXPECT_GT(nearest, 0.075F);
      } else {
        EXPECT_LT(nearest, 0.081F);
      }
    }
  }
  const SightSurface whole(points);
  for (const SightSurface::Block& block : whole.blocks()) EXPECT_EQ(block.spread_end, block.end);
}

TEST(SightSurface, TakesNoPointsAndEqualOnes) {
  EXPECT_TRUE(SightSurface(std::span<const Eigen::Vector3f>{}).blocks().empty());
  const SightSurface equal(std::vector<Eigen::Vector3f>(1000, {1, 2, 3}));
  EXPECT_EQ(equal.size(), 1000U);
  for (const SightSurface::Block& block : equal.blocks()) EXPECT_EQ(block.radius_m, 0.0F);
}

}  // namespace
}  // namespace landmarkdb
