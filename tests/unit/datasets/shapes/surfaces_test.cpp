#include <cmath>

#include <gtest/gtest.h>

#include "datasets/ray_caster.hpp"
#include "datasets/shapes/shapes.hpp"

namespace landmarkdb::datasets {
namespace {

// How far a ray from 5 m in front of the wall, at (x, z), goes; 0 for none.
float depth_at(const TriangleMesh& mesh, double x, double z) {
  const Eigen::Vector3f from(static_cast<float>(x), -5.0F, static_cast<float>(z));
  const auto hit = RayCaster(mesh).first_hit(from, {0, 1, 0}, 100.0F);
  return hit && hit->front_face ? hit->distance_m : 0.0F;
}

TEST(AddWall, HasItsFaceTowardsTheRoomAndAPaneInItsOpening) {
  TriangleMesh mesh;
  add_wall(mesh,
           at(0, 0),
           {.length_m = 6,
            .height_m = 3,
            .openings = {{.x0 = 1, .x1 = 2, .z0 = 0.5, .z1 = 2.0, .depth_m = 0.3}}});
  EXPECT_NEAR(depth_at(mesh, 0.5, 1.0), 5.0, 1e-4);
  EXPECT_NEAR(depth_at(mesh, 1.5, 1.0), 5.3, 1e-4);
  EXPECT_NEAR(depth_at(mesh, 1.5, 2.5), 5.0, 1e-4);
  EXPECT_EQ(depth_at(mesh, 7.0, 1.0), 0.0F);
}

TEST(AddWall, CanBeLookedThroughWhereAnOpeningGoesThrough) {
  TriangleMesh mesh;
  add_wall(mesh,
           at(0, 0),
           {.length_m = 4,
            .height_m = 3,
            .thickness_m = 0.2,
            .openings = {{.x0 = 1, .x1 = 2, .z0 = 0.0, .z1 = 2.0, .through = true}}});
  EXPECT_EQ(depth_at(mesh, 1.5, 1.0), 0.0F);
  EXPECT_NEAR(depth_at(mesh, 3.0, 1.0), 5.0, 1e-4);
  const auto from_behind = RayCaster(mesh).first_hit({3, 5, 1}, {0, -1, 0}, 100.0F);
  ASSERT_TRUE(from_behind);
  EXPECT_TRUE(from_behind->front_face);
  EXPECT_NEAR(from_behind->distance_m, 4.8, 1e-4);
}

TEST(AddWall, MarksPanesOfGlass) {
  TriangleMesh mesh;
  begin_object(mesh, "wall");
  add_wall(mesh,
           at(0, 0),
           {.length_m = 4,
            .height_m = 3,
            .openings = {{.x0 = 1, .x1 = 2, .material = Material::kGlass}}});
  const RayCaster caster(mesh);
  EXPECT_FALSE(caster.first_hit({1.5F, -5, 1}, {0, 1, 0}, 100.0F)->returns_light);
  EXPECT_TRUE(caster.first_hit({3.0F, -5, 1}, {0, 1, 0}, 100.0F)->returns_light);
}

TEST(AddSheet, HasTheHeightAsked) {
  TriangleMesh mesh;
  add_sheet(mesh, at(0, 0), {2, 2}, 0.1, [](double x, double) { return 0.25 * x; });
  const auto hit = RayCaster(mesh).first_hit({1, 1, 5}, {0, 0, -1}, 100.0F);
  ASSERT_TRUE(hit);
  EXPECT_TRUE(hit->front_face);
  EXPECT_NEAR(hit->distance_m, 4.75, 1e-3);
}

TEST(SmoothNoise, IsBoundedSmoothAndItsOwnForEachSeed) {
  double largest = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(0.037 * i, -0.011 * i, 0.5);
    const double here = smooth_noise(p, 1);
    largest = std::max(largest, std::abs(here));
    EXPECT_NEAR(smooth_noise(p + Eigen::Vector3d(1e-4, 0, 0), 1), here, 1e-3);
  }
  EXPECT_LE(largest, 1.0);
  EXPECT_GT(largest, 0.3);
  EXPECT_NE(smooth_noise({0.3, 0.3, 0.3}, 1), smooth_noise({0.3, 0.3, 0.3}, 2));
}

}  // namespace
}  // namespace landmarkdb::datasets
