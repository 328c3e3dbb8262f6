#include "engine/cloud/cell_grid.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(
        Eigen::Vector3d(random.uniform(-2, 3), random.uniform(-1, 1), random.uniform(0, 2))
            .cast<float>());
  }
  return points;
}

TEST(CellGrid, FindsWhatBruteForceFinds) {
  const std::vector<Eigen::Vector3f> points = random_points(800, 1);
  for (const double cell_m : {0.05, 0.2, 1.0, 50.0}) {
    const CellGrid grid(points, cell_m);
    ASSERT_EQ(grid.size(), points.size());
    std::vector<CellGrid::Found> found;
    for (std::size_t q = 0; q < points.size(); q += 37) {
      // Queries on points, beside them and far outside.
      const Eigen::Vector3f query =
          points[q] + Eigen::Vector3f::Constant(static_cast<float>(q % 3));
      for (const float radius_m : {0.1F, 0.3F, 2.0F}) {
        grid.within(query, radius_m, found);
        std::set<std::uint32_t> indices;
        for (const CellGrid::Found& f : found) {
          indices.insert(grid.order()[f.place]);
          EXPECT_EQ(grid.point(f.place), points[grid.order()[f.place]]);
          EXPECT_NEAR(f.squared_distance_m2, (grid.point(f.place) - query).squaredNorm(), 1e-5F);
        }
        EXPECT_EQ(indices.size(), found.size());
        std::set<std::uint32_t> expected;
        for (std::size_t i = 0; i < points.size(); ++i) {
          const Eigen::Vector3f d = points[i] - query;
          const float squared = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
          if (squared < radius_m * radius_m) expected.insert(static_cast<std::uint32_t>(i));
        }
        EXPECT_EQ(indices, expected);
      }
    }
  }
}

TEST(CellGrid, FindsTheSameInACloudTooWideForATableOfColumns) {
  std::vector<Eigen::Vector3f> points = random_points(300, 6);
  const CellGrid near(points, 0.1);
  points.emplace_back(5000.0F, -4000.0F, 0.0F);  // 10^9 columns
  const CellGrid wide(points, 0.1);
  std::vector<CellGrid::Found> found;
  for (const Eigen::Vector3f& query : points) {
    std::set<std::uint32_t> expected;
    near.within(query, 0.4F, found);
    for (const CellGrid::Found& f : found) expected.insert(near.order()[f.place]);
    if (query == points.back()) expected.insert(300);
    std::set<std::uint32_t> indices;
    wide.within(query, 0.4F, found);
    for (const CellGrid::Found& f : found) indices.insert(wide.order()[f.place]);
    EXPECT_EQ(indices, expected);
  }
}

TEST(CellGrid, RunsAscendWithoutOverlap) {
  const std::vector<Eigen::Vector3f> points = random_points(500, 2);
  const CellGrid grid(points, 0.3);
  std::vector<CellGrid::Run> runs;
  grid.runs(points[0], 0.6F, runs);
  ASSERT_FALSE(runs.empty());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    EXPECT_LT(runs[i].begin, runs[i].end);
    EXPECT_TRUE(i == 0 || runs[i - 1].end <= runs[i].begin);
  }
}

TEST(CellGrid, OrdersTheSameHoweverOftenAndKeepsDuplicates) {
  std::vector<Eigen::Vector3f> points = random_points(100, 3);
  points.insert(points.end(), points.begin(), points.begin() + 50);
  const CellGrid a(points, 0.2);
  const CellGrid b(points, 0.2);
  EXPECT_TRUE(std::equal(a.order().begin(), a.order().end(), b.order().begin(), b.order().end()));
  std::vector<CellGrid::Found> found;
  a.within(points[3], 1e-3F, found);
  EXPECT_EQ(found.size(), 2U);
}

TEST(CellGrid, TakesNoPointsAndAreasWithout) {
  std::vector<CellGrid::Found> found(3);
  CellGrid({}, 0.1).within({0, 0, 0}, 1.0F, found);
  EXPECT_TRUE(found.empty());
  const std::vector<Eigen::Vector3f> one = {{1e6F, -1e6F, 0}};
  const CellGrid grid(one, 0.1);
  grid.within({-1e30F, 1e30F, 1e30F}, 1.0F, found);
  EXPECT_TRUE(found.empty());
  grid.within(one[0], 1.0F, found);
  EXPECT_EQ(found.size(), 1U);
}

TEST(CellGrid, RefusesCellsThatCannotBe) {
  const std::vector<Eigen::Vector3f> points = {{0, 0, 0}, {1, 0, 0}};
  for (const double bad : {0.0,
                           -1.0,
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(),
                           1e-7,
                           1e-300}) {
    EXPECT_THROW(CellGrid(points, bad), Error) << bad;
  }
  EXPECT_NO_THROW(CellGrid(points, 1e-6));
}

TEST(CellKeys, PackAndUnpackTheWholeRange) {
  constexpr std::int64_t kMax = (std::int64_t{1} << 21) - 1;
  for (const std::array<std::int64_t, 3>& cell :
       {std::array<std::int64_t, 3>{0, 0, 0}, {kMax, 0, kMax}, {1, kMax, 2}, {kMax, kMax, kMax}}) {
    EXPECT_EQ(unpack_cell(pack_cell(cell[0], cell[1], cell[2])), cell);
  }
}

TEST(CellGrid, HasEachPointInOneCellAndInTheBallAroundIt) {
  Random random(8);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 500; ++i) {
    points.push_back(
        Eigen::Vector3d(random.uniform(), random.uniform(), random.uniform()).cast<float>());
  }
  const CellGrid grid(points, 0.2);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < grid.cells(); ++i) {
    const CellGrid::Run cell = grid.cell(i);
    const CellGrid::Ball ball = grid.ball_around(cell);
    EXPECT_EQ(cell.begin, seen);
    EXPECT_LT(cell.begin, cell.end);
    EXPECT_LE(ball.radius_m, 0.2F * std::sqrt(3.0F));
    for (std::uint32_t place = cell.begin; place < cell.end; ++place) {
      EXPECT_LE((grid.point(place) - ball.centre).norm(), ball.radius_m);
    }
    seen = cell.end;
  }
  EXPECT_EQ(seen, points.size());
}

}  // namespace
}  // namespace landmarkdb
