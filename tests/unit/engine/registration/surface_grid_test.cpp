#include "engine/registration/surface_grid.hpp"

#include <cmath>
#include <limits>
#include <stop_token>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// Cells as the grid cuts them: float, so that far from zero both round alike.
Eigen::Vector3f centre_of_cell(const Eigen::Vector3f& p, float cell_m) {
  const float inverse = static_cast<float>(1.0 / static_cast<double>(cell_m));
  return ((p.array() * inverse).floor() + 0.5F).matrix() * cell_m;
}

struct Cloud {
  std::vector<Eigen::Vector3f> points, normals;
};

Cloud random_cloud(std::size_t count, const Eigen::Vector3f& around, float size, Random& random) {
  Cloud cloud;
  const auto draw = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)); };
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.emplace_back(around + size * Eigen::Vector3f(draw(), draw(), draw()));
    cloud.normals.emplace_back(Eigen::Vector3f(draw(), draw(), draw() + 2.0F).normalized());
  }
  return cloud;
}

// Holds near() against the nearest of all points to the centre of the cell asked.
void expect_like_brute_force(const Eigen::Vector3f& around, float cell_m, int reach) {
  Random random(1);
  const float size = 20.0F * cell_m;
  const Cloud cloud = random_cloud(3000, around, size, random);
  const SurfaceGrid grid(cloud.points, cloud.normals, cell_m, reach);
  const float rounding = 4e-6F * around.cwiseAbs().maxCoeff() + 1e-5F * cell_m;
  int found = 0, empty = 0;
  const Cloud asked = random_cloud(1500, around, 1.3F * size, random);
  for (const Eigen::Vector3f& p : asked.points) {
    const Eigen::Vector3f centre = centre_of_cell(p, cell_m);
    float nearest = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& q : cloud.points) nearest = std::min(nearest, (q - centre).norm());
    const Surfel* surfel = grid.near(p);
    // Within reach of the cell's centre there must be an answer, the best one.
    if (nearest < grid.reach_m() - rounding) {
      ASSERT_NE(surfel, nullptr);
      ASSERT_NEAR((surfel->point - centre).norm(), nearest, rounding);
    }
    // What lies further than reach and one cell's diagonal must not be named.
    if (nearest > grid.reach_m() + 0.87F * cell_m + rounding) {
      ASSERT_EQ(surfel, nullptr);
    }
    surfel != nullptr ? ++found : ++empty;
  }
  EXPECT_GT(found, 20);
  EXPECT_GT(empty, 20);
}

TEST(SurfaceGrid, NamesTheNearestSurfelWithinReachAndNothingBeyond) {
  for (const int reach : {0, 1, 2, 3}) {
    expect_like_brute_force(Eigen::Vector3f::Zero(), 0.05F, reach);
  }
}

// A block is filled again where later points of a large cloud come near it.
TEST(SurfaceGrid, NamesTheNearestOfMorePointsThanAreFilledAtATime) {
  Random random(5);
  const float cell_m = 0.05F;
  const Cloud cloud = random_cloud(300'000, Eigen::Vector3f::Zero(), 1.0F, random);
  const SurfaceGrid grid(cloud.points, cloud.normals, cell_m, 2);
  for (const Eigen::Vector3f& p : random_cloud(60, {0, 0, 0}, 0.9F, random).points) {
    const Eigen::Vector3f centre = centre_of_cell(p, cell_m);
    float nearest = std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& q : cloud.points) nearest = std::min(nearest, (q - centre).norm());
    const Surfel* surfel = grid.near(p);
    ASSERT_NE(surfel, nullptr);
    EXPECT_NEAR((surfel->point - centre).norm(), nearest, 1e-6F);
  }
}

TEST(SurfaceGrid, IsTheSameOnAnyNumberOfThreads) {
  Random random(6);
  const Cloud cloud = random_cloud(5000, {0.3F, 0.0F, -0.2F}, 1.0F, random);
  RunContext three;
  three.threads = 3;
  const SurfaceGrid one_thread(cloud.points, cloud.normals, 0.05, 2);
  const SurfaceGrid more(cloud.points, cloud.normals, 0.05, 2, three);
  EXPECT_EQ(one_thread.memory_bytes(), more.memory_bytes());
  for (const Eigen::Vector3f& p : random_cloud(5000, {0, 0, 0}, 1.5F, random).points) {
    ASSERT_EQ(one_thread.stored_at(p), more.stored_at(p));
  }
}

TEST(SurfaceGrid, WorksOnBothSidesOfZeroAndAcrossBlocks) {
  expect_like_brute_force({-0.4F, 0.4F, -0.8F}, 0.05F, 2);  // a block is 0.4 m
  expect_like_brute_force({-7.3F, -2.1F, -11.0F}, 0.05F, 2);
  expect_like_brute_force({0.001F, -0.002F, 0.0F}, 0.0001F, 2);
}

TEST(SurfaceGrid, WorksFarFromZero) {
  expect_like_brute_force({900.0F, -700.0F, 300.0F}, 0.05F, 2);
  expect_like_brute_force({-4000.0F, 9000.0F, 0.0F}, 0.5F, 2);
}

// Two clouds so far apart that no table of the box between them would be reasonable.
TEST(SurfaceGrid, HoldsWhatIsKilometresApart) {
  Random random(3);
  const float cell_m = 0.05F;
  Cloud cloud = random_cloud(500, {0, 0, 0}, 1.0F, random);
  const Cloud other = random_cloud(500, {3000, -2000, 500}, 1.0F, random);
  cloud.points.insert(cloud.points.end(), other.points.begin(), other.points.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  const SurfaceGrid far(cloud.points, cloud.normals, cell_m, 2);
  EXPECT_LT(far.memory_bytes(), std::size_t{64} << 20U);
  const SurfaceGrid alone(other.points, other.normals, cell_m, 2);
  int found = 0;
  for (const Eigen::Vector3f& p : random_cloud(2000, {3000, -2000, 500}, 1.2F, random).points) {
    const Surfel* expected = alone.near(p);
    const Surfel* surfel = far.near(p);
    ASSERT_EQ(surfel == nullptr, expected == nullptr);
    if (surfel == nullptr) continue;
    ++found;
    EXPECT_EQ(surfel->point, expected->point);
  }
  EXPECT_GT(found, 100);
  EXPECT_EQ(far.near({1500, -1000, 250}), nullptr);
}

TEST(SurfaceGrid, GivesBackPointAndNormalOfOneAndTheSameSurfel) {
  Random random(2);
  const Cloud cloud = random_cloud(500, Eigen::Vector3f::Zero(), 3.0F, random);
  const SurfaceGrid grid(cloud.points, cloud.normals, 0.01, 1);
  ASSERT_EQ(grid.surfels().size(), 500U);
  int same = 0;
  for (std::size_t i = 0; i < 500; ++i) {
    const Surfel* surfel = grid.near(cloud.points[i]);
    ASSERT_NE(surfel, nullptr);
    if (surfel->point != cloud.points[i]) continue;  // two in one cell
    EXPECT_EQ(surfel->normal, cloud.normals[i]);
    ++same;
  }
  EXPECT_GT(same, 480);
}

TEST(SurfaceGrid, GrowsWithItsSurfaceAndLosesNothing) {
  // A plane of 40 m: thousands of blocks, several growths of the table.
  Cloud cloud;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 200; ++j) {
      cloud.points.emplace_back(
          0.2F * static_cast<float>(i) - 20.0F, 0.2F * static_cast<float>(j) - 20.0F, 0.0F);
      cloud.normals.emplace_back(0.0F, 0.0F, 1.0F);
    }
  }
  const SurfaceGrid grid(cloud.points, cloud.normals, 0.1, 1);
  for (const Eigen::Vector3f& p : cloud.points) {
    const Surfel* surfel = grid.near(p + Eigen::Vector3f(0.01F, 0.01F, 0.05F));
    ASSERT_NE(surfel, nullptr);
    ASSERT_LT((surfel->point - p).norm(), 0.15F);
  }
  EXPECT_EQ(grid.near({0.0F, 0.0F, 0.5F}), nullptr);
  EXPECT_GT(grid.memory_bytes(), 40'000 * sizeof(Surfel));
}

TEST(SurfaceGrid, AnswersForPointsThatNoScanReaches) {
  const SurfaceGrid grid({{Eigen::Vector3f(1, 2, 3)}}, {{Eigen::Vector3f(0, 0, 1)}}, 0.05, 2);
  const float far = std::numeric_limits<float>::max();
  EXPECT_EQ(grid.near({far, 0, 0}), nullptr);
  EXPECT_EQ(grid.near({-far, far, -far}), nullptr);
  EXPECT_EQ(grid.near({1e9F, -1e9F, 1e9F}), nullptr);
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(grid.near({infinity, 0, -infinity}), nullptr);
  EXPECT_NE(grid.near({1, 2, 3}), nullptr);
}

TEST(SurfaceGrid, IsEmptyWithoutPoints) {
  const SurfaceGrid grid({}, {}, 0.05, 2);
  EXPECT_EQ(grid.near({0, 0, 0}), nullptr);
  EXPECT_TRUE(grid.surfels().empty());
}

// Points that each lie alone, some cells apart.
std::vector<Eigen::Vector3f> lone_points(int a_side) {
  std::vector<Eigen::Vector3f> points;
  for (int x = 0; x < a_side; ++x) {
    for (int y = 0; y < a_side; ++y) {
      for (int z = 0; z < a_side; ++z) points.emplace_back(Eigen::Vector3i(x, y, z).cast<float>());
    }
  }
  return points;
}

TEST(SurfaceGridSize, ForetellsWhatTheGridTakes) {
  Random random(3);
  const Cloud cloud = random_cloud(20'000, Eigen::Vector3f(5, -3, 1), 2.0F, random);
  const SurfaceGrid grid(cloud.points, cloud.normals, 0.05, 2);
  const GridSize size = SurfaceGrid::size_for(cloud.points, 0.05, 2);
  EXPECT_EQ(size.points, 20'000U);
  EXPECT_GT(size.blocks, 1000U);
  EXPECT_NEAR(static_cast<double>(size.bytes()) / static_cast<double>(grid.memory_bytes()), 1, 0.1);
}

// Such cells used to be laid over one another without a word.
TEST(SurfaceGridSize, RefusesPointsPastTheNumbersOfCells) {
  const std::vector<Eigen::Vector3f> points = {{0, 0, 0}, {0, -100, 0}};
  try {
    SurfaceGrid::size_for(points, 1e-5, 2);
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.field(), "voxel");
    EXPECT_THAT(error.what(), ::testing::HasSubstr("1e+07 cells, the limit is 1048544"));
  }
  EXPECT_THROW(SurfaceGrid(points, points, 1e-5, 2), Error);
  EXPECT_NO_THROW(SurfaceGrid(points, points, 1e-4, 2));
}

// A voxel far below the spacing: each point gets blocks of its own.
TEST(SurfaceGridSize, RefusesMoreBlocksThanTheLimitAndSaysHowMany) {
  const std::vector<Eigen::Vector3f> points = lone_points(100);
  EXPECT_EQ(SurfaceGrid::size_for(lone_points(10), 0.01, 0).blocks, 1000U);
  try {
    SurfaceGrid::size_for(points, 0.01, 6);
    FAIL() << "taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.field(), "voxel");
    EXPECT_THAT(error.what(), ::testing::HasSubstr("the limit is 2097152"));
  }
}

TEST(SurfaceGrid, StopsWhenTold) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  const std::vector<Eigen::Vector3f> points = lone_points(3);
  EXPECT_THROW(SurfaceGrid(points, points, 0.1, 2, context), Error);
  EXPECT_THROW(SurfaceGrid::size_for(points, 0.1, 2, context), Error);
}

}  // namespace
}  // namespace landmarkdb
