#include "engine/mono/edge_wishes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// Points in pixels drawn at random, a share of all, with directions drawn at random.
EdgeMap random_map(std::size_t width, std::size_t height, double share, std::uint64_t seed) {
  Random random(seed);
  EdgeMap map;
  for (std::size_t y = 0; y < height; ++y) {
    map.row_starts.push_back(static_cast<std::uint32_t>(map.points.size()));
    for (std::size_t x = 0; x < width; ++x) {
      if (random.uniform() >= share) continue;
      const double angle = 6.28 * random.uniform();
      const double u = static_cast<double>(x) + random.uniform() - 0.5;
      const double v = static_cast<double>(y) + random.uniform() - 0.5;
      map.points.push_back(
          {{static_cast<float>(u), static_cast<float>(v)},
           {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))}});
      map.columns.push_back(static_cast<std::int32_t>(x));
    }
  }
  map.row_starts.push_back(static_cast<std::uint32_t>(map.points.size()));
  map.contrasts.assign(map.points.size(), 10.0F);
  return map;
}

std::vector<std::int64_t> rows_of(const EdgeMap& map) {
  std::vector<std::int64_t> rows;
  for (std::size_t y = 0; y + 1 < map.row_starts.size(); ++y)
    rows.insert(
        rows.end(), map.row_starts[y + 1] - map.row_starts[y], static_cast<std::int64_t>(y));
  return rows;
}

// What find_link_wishes() says, from all pairs of points.
std::vector<LinkWishes> wishes_of_all_pairs(const EdgeMap& map) {
  const std::vector<std::int64_t> rows = rows_of(map);
  std::vector<LinkWishes> wishes(map.points.size());
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    for (std::size_t j = 0; j < map.points.size(); ++j) {
      const EdgePoint &p = map.points[i], &q = map.points[j];
      if (i == j || std::abs(map.columns[i] - map.columns[j]) > 2 ||
          std::abs(rows[i] - rows[j]) > 2 || p.normal.dot(q.normal) < 0.5F) {
        continue;
      }
      const Eigen::Vector2f step = q.uv - p.uv;
      const float along = -p.normal.y() * step.x() + p.normal.x() * step.y();
      const float aside = p.normal.dot(step);
      if (!(std::abs(along) > 0.2F)) continue;
      const float cost = along * along + 2.0F * aside * aside;
      LinkWish& known = wishes[i].ways[along < 0.0F ? 1 : 0];
      known = std::min(known, (LinkWish{std::bit_cast<std::uint32_t>(cost)} << 32U) | j);
    }
  }
  return wishes;
}

void expect_as_of_all_pairs(const EdgeMap& map) {
  const std::vector<LinkWishes> found = find_link_wishes(map, {});
  const std::vector<LinkWishes> want = wishes_of_all_pairs(map);
  ASSERT_EQ(found.size(), want.size());
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i].ways, want[i].ways) << i;
}

TEST(FindLinkWishes, AreThoseOfAllPairsOfPoints) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    for (const double share : {0.05, 0.3, 1.0}) {
      expect_as_of_all_pairs(random_map(5 + seed, 12, share, seed));
    }
  }
}

TEST(FindLinkWishes, HoldInImagesOfOneRowOrColumn) {
  for (const double share : {0.5, 1.0}) {
    expect_as_of_all_pairs(random_map(1, 40, share, 3));
    expect_as_of_all_pairs(random_map(40, 1, share, 3));
    expect_as_of_all_pairs(random_map(1, 1, share, 3));
  }
}

TEST(FindLinkWishes, AreNoneWithoutPoints) {
  EXPECT_TRUE(find_link_wishes(random_map(20, 20, 0.0, 1), {}).empty());
}

TEST(FindLinkWishes, AreNoneOfAPointAlone) {
  EdgeMap map = random_map(1, 1, 1.0, 1);
  const std::vector<LinkWishes> wishes = find_link_wishes(map, {});
  ASSERT_EQ(wishes.size(), 1U);
  EXPECT_EQ(wishes[0].ahead(), kNoEdgePoint);
  EXPECT_EQ(wishes[0].behind(), kNoEdgePoint);
}

}  // namespace
}  // namespace landmarkdb
