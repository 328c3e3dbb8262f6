#include "datasets/ray_caster.hpp"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

Eigen::Vector3d corner(const TriangleMesh& mesh, std::size_t triangle, std::size_t k) {
  return mesh.vertices[mesh.triangles[triangle][k]].cast<double>();
}

// Distance by solving for the plane and the side of each edge, in double; infinity for a miss.
double plain_distance(const TriangleMesh& mesh,
                      const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3d a = corner(mesh, i, 0);
    const Eigen::Vector3d b = corner(mesh, i, 1);
    const Eigen::Vector3d c = corner(mesh, i, 2);
    const Eigen::Vector3d n = (b - a).cross(c - a);
    const double t = n.dot(a - origin) / n.dot(direction);
    const Eigen::Vector3d p = origin + t * direction;
    const bool inside = n.dot((b - a).cross(p - a)) >= 0 && n.dot((c - b).cross(p - b)) >= 0 &&
                        n.dot((a - c).cross(p - c)) >= 0;
    if (inside && t > 1e-4 && t < nearest) nearest = t;
  }
  return nearest;
}

TriangleMesh random_triangles(int count) {
  Random random(7);
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const auto draw = [&](double size) {
      return Eigen::Vector3d(
          random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
    };
    const Eigen::Vector3d a = draw(5.0);
    add_triangle(mesh, a, a + draw(0.6), a + draw(0.6));
  }
  return mesh;
}

TEST(RayCaster, FindsTheSameSurfacesAsTryingEveryTriangle) {
  const TriangleMesh mesh = random_triangles(600);
  const RayCaster caster(mesh);
  Random random(3);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d origin(
        random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(-6, 6));
    const Eigen::Vector3d direction =
        Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const double truth = plain_distance(mesh, origin, direction);
    const auto hit = caster.first_hit(origin.cast<float>(), direction.cast<float>(), 100.0F);
    ASSERT_EQ(hit.has_value(), std::isfinite(truth)) << "ray " << i;
    if (!hit) continue;
    ++hits;
    ASSERT_NEAR(hit->distance_m, truth, 1e-3) << "ray " << i;
  }
  EXPECT_GT(hits, 150);
}

TEST(RayCaster, TellsTheFreeSideFromTheInside) {
  TriangleMesh mesh;
  add_box(mesh, at(0, 0), {2, 2, 2});
  const RayCaster caster(mesh);
  const auto outside = caster.first_hit({-5, 0, 1}, {1, 0, 0}, 100.0F);
  ASSERT_TRUE(outside);
  EXPECT_TRUE(outside->front_face);
  EXPECT_NEAR(outside->distance_m, 4.0, 1e-5);
  EXPECT_NEAR(outside->normal.x(), -1.0, 1e-6);
  const auto inside = caster.first_hit({0, 0, 1}, {1, 0, 0}, 100.0F);
  ASSERT_TRUE(inside);
  EXPECT_FALSE(inside->front_face);
}

TEST(RayCaster, SeesNothingBeyondTheRangeAsked) {
  TriangleMesh mesh;
  add_box(mesh, at(0, 0), {2, 2, 2});
  const RayCaster caster(mesh);
  EXPECT_FALSE(caster.first_hit({-5, 0, 1}, {1, 0, 0}, 3.9F));
  EXPECT_TRUE(caster.first_hit({-5, 0, 1}, {1, 0, 0}, 4.1F));
}

TEST(RayCaster, KnowsGlass) {
  TriangleMesh mesh;
  begin_object(mesh, "pane", Material::kGlass);
  add_box(mesh, at(0, 0), {2, 2, 2});
  EXPECT_FALSE(RayCaster(mesh).first_hit({-5, 0, 1}, {1, 0, 0}, 100.0F)->returns_light);
}

TEST(RayCaster, BlocksWhatStandsBetweenTwoPointsOnly) {
  TriangleMesh mesh;
  add_box(mesh, at(0, 0), {2, 2, 2});
  const RayCaster caster(mesh);
  EXPECT_TRUE(caster.blocked({-5, 0, 1}, {5, 0, 1}));
  EXPECT_FALSE(caster.blocked({-5, 0, 1}, {-1, 0, 1})) << "the end lies on the surface";
  EXPECT_FALSE(caster.blocked({-5, 0, 3}, {5, 0, 3}));
}

TEST(RayCaster, LivesWithManyEqualTriangles) {
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i) add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const auto hit = RayCaster(mesh).first_hit({0.2F, 0.2F, 1}, {0, 0, -1}, 10.0F);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->distance_m, 1.0, 1e-6);
}

TEST(RayCaster, OfAnEmptyMeshSeesNothing) {
  EXPECT_FALSE(RayCaster(TriangleMesh{}).first_hit({0, 0, 0}, {0, 0, 1}, 10.0F));
}

}  // namespace
}  // namespace landmarkdb::datasets
