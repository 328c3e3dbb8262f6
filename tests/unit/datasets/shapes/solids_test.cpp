#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "datasets/shapes/shapes.hpp"

namespace landmarkdb::datasets {
namespace {

// What the surface encloses, by the divergence theorem: negative when faces look inwards, and
// independent of where the origin lies only when the surface is closed.
double volume(const TriangleMesh& mesh, const Eigen::Vector3d& origin) {
  double six_times = 0.0;
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.vertices[triangle[k]].cast<double>() - origin;
    six_times += p[0].dot(p[1].cross(p[2]));
  }
  return six_times / 6.0;
}

void expect_solid(const TriangleMesh& mesh, double wanted_m3, double tolerance_m3) {
  EXPECT_NEAR(volume(mesh, {0, 0, 0}), wanted_m3, tolerance_m3);
  EXPECT_NEAR(volume(mesh, {3, -2, 5}), wanted_m3, tolerance_m3) << "not closed";
}

const Eigen::Isometry3d kSomewhere = at(1.0, -2.0, 0.5, 0.7);

TEST(AddBox, EnclosesItsVolume) {
  TriangleMesh mesh;
  add_box(mesh, kSomewhere, {1.0, 2.0, 3.0});
  expect_solid(mesh, 6.0, 1e-4);
}

TEST(AddTaperedBox, EnclosesAFrustum) {
  TriangleMesh mesh;
  add_tapered_box(mesh, kSomewhere, {2.0, 2.0, 3.0}, 0.5);
  expect_solid(mesh, 3.0 / 3.0 * (4.0 + 1.0 + 2.0), 1e-4);
}

TEST(AddPrism, EnclosesItsVolume) {
  TriangleMesh mesh;
  const std::vector<Eigen::Vector2d> outline = {{0, 0}, {1, 0}, {0, 1}};
  add_prism(mesh, kSomewhere, outline, 2.0);
  expect_solid(mesh, 1.0, 1e-4);
}

TEST(AddCylinder, EnclosesNearlyItsVolume) {
  TriangleMesh mesh;
  add_cylinder(mesh, kSomewhere, 0.5, 2.0);
  expect_solid(mesh, std::numbers::pi * 0.25 * 2.0, 0.02);
}

TEST(AddRod, RunsBetweenItsEnds) {
  TriangleMesh mesh;
  add_rod(mesh, Eigen::Isometry3d::Identity(), {0, 0, 0}, {0, 3, 4}, 0.1);
  expect_solid(mesh, std::numbers::pi * 0.01 * 5.0, 0.02);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : mesh.vertices) box.extend(p);
  EXPECT_NEAR(box.max().z(), 4.0, 0.11);
  EXPECT_NEAR(box.max().y(), 3.0, 0.11);
}

TEST(AddRod, CanPointStraightDown) {
  TriangleMesh mesh;
  add_rod(mesh, Eigen::Isometry3d::Identity(), {0, 0, 2}, {0, 0, 0}, 0.1);
  expect_solid(mesh, std::numbers::pi * 0.01 * 2.0, 0.01);
}

TEST(AddBlob, EnclosesNearlyABallWithoutRoughness) {
  TriangleMesh mesh;
  add_blob(mesh, kSomewhere, {.radii = {1, 1, 1}, .detail = 30});
  expect_solid(mesh, 4.0 / 3.0 * std::numbers::pi, 0.05);
}

TEST(AddBlob, StaysClosedWhenRoughAndBoxy) {
  TriangleMesh mesh;
  add_blob(mesh,
           kSomewhere,
           {.radii = {0.5, 0.3, 0.2}, .squareness_z = 0.3, .squareness_xy = 0.3, .roughness = 0.3});
  EXPECT_NEAR(volume(mesh, {0, 0, 0}), volume(mesh, {9, 9, 9}), 1e-3);
  EXPECT_GT(volume(mesh, {0, 0, 0}), 0.05);
}

TEST(AddTriangle, LeavesOutThoseWithoutArea) {
  TriangleMesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  EXPECT_TRUE(mesh.triangles.empty());
}

TEST(BeginObject, NamesTheTrianglesThatFollow) {
  TriangleMesh mesh;
  begin_object(mesh, "one");
  add_box(mesh, kSomewhere, {1, 1, 1});
  begin_object(mesh, "two");
  add_box(mesh, kSomewhere, {1, 1, 1});
  EXPECT_EQ(mesh.objects[mesh.object.front()].name, "one");
  EXPECT_EQ(mesh.objects[mesh.object.back()].name, "two");
}

}  // namespace
}  // namespace landmarkdb::datasets
