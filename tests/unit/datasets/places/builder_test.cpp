#include "datasets/places/builder.hpp"

#include <gtest/gtest.h>

#include "datasets/ray_caster.hpp"

namespace landmarkdb::datasets {
namespace {

Storey storey() {
  return {.options = {},
          .mesh = {},
          .plan = Random(1),
          .furnish = Random(2),
          .loose = Random(3),
          .height_m = 3.0,
          .areas = {},
          .taken = {}};
}

const std::vector<Eigen::Vector2d> kRoom = {{0, 0}, {0, 5}, {7, 5}, {7, 0}};

TEST(BuildShell, EnclosesTheRoomWithFacesToTheInside) {
  Storey s = storey();
  const std::vector<WallRun> walls = walls_between(kRoom, 3.0);
  build_shell(s, kRoom, walls);
  const RayCaster caster(s.mesh);
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const auto hit = caster.first_hit({3, 2, 1}, direction.cast<float>(), 100.0F);
    ASSERT_TRUE(hit);
    EXPECT_TRUE(hit->front_face);
    EXPECT_LT(hit->distance_m, 8.7F);
  }
}

TEST(WallsBetween, LieOnTheEdges) {
  const std::vector<WallRun> walls = walls_between(kRoom, 3.0);
  ASSERT_EQ(walls.size(), 4U);
  EXPECT_DOUBLE_EQ(walls[0].length_m, 5.0);
  EXPECT_DOUBLE_EQ(walls[1].length_m, 7.0);
  const Eigen::Vector3d end = walls[1].T_storey_wall * Eigen::Vector3d(7, 0, 0);
  EXPECT_LT((end - Eigen::Vector3d(7, 5, 0)).norm(), 1e-12);
  const Eigen::Vector3d into_room = walls[1].T_storey_wall * Eigen::Vector3d(3, -1, 0);
  EXPECT_LT((into_room - Eigen::Vector3d(3, 4, 0)).norm(), 1e-12);
}

TEST(Reserve, GivesNoStretchTwice) {
  WallRun wall = walls_between(kRoom, 3.0)[1];
  Random random(1);
  std::vector<double> starts;
  while (const auto x0 = reserve(wall, random, 1.0, Band::kLow)) starts.push_back(*x0);
  ASSERT_GT(starts.size(), 2U);
  std::sort(starts.begin(), starts.end());
  for (std::size_t i = 1; i < starts.size(); ++i) EXPECT_GE(starts[i] - starts[i - 1], 1.0);
}

TEST(Reserve, LeavesPicturesRoomAboveFurniture) {
  WallRun wall = walls_between(kRoom, 3.0)[1];
  EXPECT_TRUE(reserve_at(wall, 1.0, 2.0, Band::kLow));
  EXPECT_TRUE(reserve_at(wall, 1.0, 2.0, Band::kHigh));
  EXPECT_FALSE(reserve_at(wall, 2.0, 1.0, Band::kBoth));
  EXPECT_FALSE(reserve_at(wall, 6.5, 1.0, Band::kBoth)) << "beyond the end";
}

TEST(Reserve, FindsNothingOnAWallTooShort) {
  WallRun wall = walls_between(kRoom, 3.0)[0];
  Random random(1);
  EXPECT_FALSE(reserve(wall, random, 5.0, Band::kLow));
}

TEST(FindSpot, KeepsThingsApartAndWithin) {
  Storey s = storey();
  const Eigen::AlignedBox2d box(Eigen::Vector2d(0, 0), Eigen::Vector2d(7, 5));
  std::vector<Eigen::Vector2d> spots;
  while (const auto spot = find_spot(s, s.loose, box, 0.8)) spots.push_back(*spot);
  ASSERT_GT(spots.size(), 3U);
  for (std::size_t i = 0; i < spots.size(); ++i) {
    EXPECT_TRUE(box.contains(spots[i]));
    for (std::size_t k = 0; k < i; ++k) EXPECT_GE((spots[i] - spots[k]).norm(), 1.6);
  }
  EXPECT_FALSE(find_spot(s, s.loose, box, 4.0));
}

TEST(OpenDoor, CutsADoorThatStandsOnTheFloor) {
  WallRun wall = walls_between(kRoom, 3.0)[1];
  Random random(1);
  ASSERT_TRUE(open_door(wall, random, 0.2));
  EXPECT_EQ(wall.openings[0].z0, 0.0);
  EXPECT_GT(wall.openings[0].z1, 1.9);
  EXPECT_GT(wall.openings[0].x1 - wall.openings[0].x0, 0.8);
}

TEST(ScatterClutter, FollowsTheAmountAsked) {
  const Eigen::AlignedBox2d box(Eigen::Vector2d(0, 0), Eigen::Vector2d(20, 20));
  Storey none = storey();
  none.options.clutter = 0.0;
  scatter_clutter(none, box, 0.05);
  EXPECT_TRUE(none.mesh.triangles.empty());
  Storey some = storey();
  scatter_clutter(some, box, 0.05);
  EXPECT_EQ(some.taken.size(), 20U);
}

}  // namespace
}  // namespace landmarkdb::datasets
