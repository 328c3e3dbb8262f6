#include "engine/cloud/read_mesh.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using testing::parse;
using ::testing::ThrowsMessage;

// Distance to the surface of the unit cube, from inside or outside along one axis.
float off_cube(const Eigen::Vector3f& p) {
  float nearest = 1.0F;
  for (int axis = 0; axis < 3; ++axis) {
    nearest = std::min({nearest, std::abs(p[axis]), std::abs(p[axis] - 1.0F)});
  }
  return nearest;
}

TEST(ReadMesh, SpreadsSamplesEvenlyOverAnObjCube) {
  const PointCloud cloud = parse(testing::obj_cube(), "a.obj", {.mesh_spacing_m = 0.05});
  EXPECT_NEAR(static_cast<double>(cloud.size()), 6.0 / (0.05 * 0.05), 3.0);
  std::array<int, 8> corners{};
  for (const Eigen::Vector3f& p : cloud.points) {
    EXPECT_LT(off_cube(p), 1e-6F);
    corners[(p.x() > 0.5F ? 1U : 0U) + (p.y() > 0.5F ? 2U : 0U) + (p.z() > 0.5F ? 4U : 0U)]++;
  }
  for (const int count : corners) EXPECT_NEAR(count, 300, 30);
  // No sample is further than two spacings from the next: no holes, no clusters without company.
  const SpatialIndex index(cloud.points);
  std::vector<Neighbour> near;
  for (const Eigen::Vector3f& p : cloud.points) {
    index.nearest(p, 2, near);
    EXPECT_LT(std::sqrt(near[1].squared_distance_m2), 0.1F);
  }
}

TEST(ReadMesh, GivesAClosedMeshOutwardNormals) {
  for (const auto& [name, file] : {std::pair{"a.obj", testing::obj_cube()},
                                   std::pair{"a.stl", testing::stl_ascii()},
                                   std::pair{"b.stl", testing::stl_binary()}}) {
    const PointCloud cloud = parse(file, name);
    ASSERT_EQ(cloud.normals.size(), cloud.size()) << name;
    const float centre = std::string_view(name) == "a.obj" ? 0.5F : 0.25F;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const Eigen::Vector3f away = cloud.points[i] - Eigen::Vector3f::Constant(centre);
      EXPECT_GT(cloud.normals[i].dot(away), 0.0F) << name;
    }
  }
}

TEST(ReadMesh, ReadsBothKindsOfStlAlike) {
  const PointCloud ascii = parse(testing::stl_ascii(), "a.stl");
  const PointCloud binary = parse(testing::stl_binary(), "b.stl");
  ASSERT_EQ(ascii.size(), binary.size());
  EXPECT_EQ(ascii.points, binary.points);
}

TEST(ReadMesh, ReadsAnObjWithoutFacesAsItsVertices) {
  const PointCloud cloud = parse("v 1 2 3 1 0 0.5\nv 4 5 6 0 0 1\n", "a.obj");
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(4, 5, 6));
  ASSERT_EQ(cloud.colours.size(), 2U);
  EXPECT_EQ(cloud.colours[0], (std::array<std::uint8_t, 3>{255, 0, 128}));
}

TEST(ReadMesh, RefusesFacesOfVerticesThatAreNotThere) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face : {"f 1 2 4\n",
                           "f 0 1 2\n",
                           "f -1 -2 -4\n",
                           "f 1 2 x\n",
                           "f 1 2\n",
                           "f 1 2 99999999999999999999\n"}) {
    EXPECT_THAT([&] { parse(vertices + face, "a.obj"); }, ThrowsMessage<Error>(HasSubstr("line 4")))
        << face;
  }
}

TEST(ReadMesh, RefusesAMeshWithoutArea) {
  EXPECT_THAT([&] { parse("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "a.obj"); },
              ThrowsMessage<Error>(HasSubstr("no area")));
  EXPECT_THAT([&] { parse("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a.obj"); },
              ThrowsMessage<Error>(HasSubstr("no area")));
}

TEST(ReadMesh, RefusesASpacingThatAsksForTooManyPoints) {
  EXPECT_THAT(
      [&] { parse(testing::obj_cube(), "a.obj", {.max_points = 1000, .mesh_spacing_m = 1e-4}); },
      ThrowsMessage<Error>(HasSubstr("more than 1000 points")));
}

TEST(ReadMesh, RefusesStlThatLiesOrIsCutOff) {
  std::string binary = testing::stl_binary();
  binary[80] = '\x05';
  binary[0] = '\x01';  // not text, so that only the name says STL
  EXPECT_THAT([&] { parse(binary, "b.stl"); }, ThrowsMessage<Error>(HasSubstr("5 triangles")));
  const std::string ascii = testing::stl_ascii();
  EXPECT_THAT([&] { parse(ascii.substr(0, ascii.size() / 2), "a.stl"); },
              ThrowsMessage<Error>(HasSubstr("endsolid")));
}

}  // namespace
}  // namespace landmarkdb
