#include "engine/registration/scanned_space.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::Surface;

constexpr double kCell_m = 0.05;
const Eigen::Vector3f kViewpoint(1.5F, 1.5F, 1.2F);

// The corner room is scanned from within.
struct Room {
  Surface surface = testing::corner_room(0.02);
  SurfaceGrid grid{surface.points, surface.normals, kCell_m, 2};

  ScannedSpace seen_from(const std::vector<Eigen::Vector3f>& viewpoints,
                         const std::vector<std::uint16_t>& index = {}) const {
    return ScannedSpace(surface.points, viewpoints, index, grid);
  }
};

TEST(ScannedSpace, IsEmptyBetweenTheScannerAndWhatItMet) {
  const Room room;
  const ScannedSpace space = room.seen_from({kViewpoint});
  ASSERT_TRUE(space.known());
  EXPECT_GT(space.memory_bytes(), 10'000U);
  for (std::size_t i = 0; i < room.surface.points.size(); i += 97) {
    const Eigen::Vector3f& p = room.surface.points[i];
    EXPECT_FALSE(space.is_empty_at(p)) << "the surface itself";
    EXPECT_FALSE(space.is_empty_at(p - 0.1F * room.surface.normals[i])) << "behind it";
    EXPECT_FALSE(space.is_empty_at(p + 0.12F * (kViewpoint - p).normalized())) << "too near";
  }
  EXPECT_TRUE(space.is_empty_at({1.0F, 1.0F, 0.7F}));
  EXPECT_FALSE(space.is_empty_at({-3.0F, 1.0F, 1.0F})) << "nobody saw behind the walls";
  EXPECT_FALSE(space.is_empty_at(kViewpoint));
}

TEST(ScannedSpace, KnowsNothingWithoutAViewpoint) {
  const ScannedSpace space = Room().seen_from({});
  EXPECT_FALSE(space.known());
  EXPECT_FALSE(space.is_empty_at({1, 1, 1}));
  EXPECT_FALSE(ScannedSpace().known());
}

TEST(ScannedSpace, PassesOverAViewpointThatCannotHaveSeenThePoints) {
  const Room room;
  EXPECT_FALSE(room.seen_from({{-3, -3, 1.2F}}).known()) << "from outside, through the walls";
}

TEST(ScannedSpace, TakesEachViewpointWithItsOwnPoints) {
  const Room room;
  std::vector<std::uint16_t> index;
  for (const Eigen::Vector3f& p : room.surface.points) index.push_back(p.x() < 1.5F ? 0 : 1);
  const ScannedSpace space = room.seen_from({kViewpoint, {-3, -3, 1.2F}}, index);
  ASSERT_TRUE(space.known());
  EXPECT_TRUE(space.is_empty_at({0.8F, 1.2F, 0.7F})) << "towards the first one's points";
  EXPECT_FALSE(space.is_empty_at({2.2F, 1.5F, 0.5F})) << "the second one is not believed";
}

}  // namespace
}  // namespace landmarkdb
