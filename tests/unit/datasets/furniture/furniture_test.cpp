#include "datasets/furniture/furniture.hpp"

#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace landmarkdb::datasets {
namespace {

struct Piece {
  std::string name;
  double reach_m;  // no part of it is further from its origin
  std::function<void(Workshop, const Eigen::Isometry3d&)> add;
};

const std::vector<Piece>& pieces() {
  using T = const Eigen::Isometry3d&;
  static const std::vector<Piece> all = {
      {"desk", 2.0, add_desk},
      {"office_chair", 1.3, add_office_chair},
      {"shelf", 3.0, [](Workshop s, T t) { add_shelf(s, t, 1.2); }},
      {"cabinet", 2.6, add_cabinet},
      {"bin", 1.0, add_bin},
      {"partition", 2.0, [](Workshop s, T t) { add_partition(s, t, 1.5); }},
      {"table", 2.5, [](Workshop s, T t) { add_table_with_chairs(s, t, 2.0, 5); }},
      {"sofa", 1.8, [](Workshop s, T t) { add_sofa(s, t, 1.8); }},
      {"low_table", 1.0, add_low_table},
      {"plant", 2.8, add_plant},
      {"floor_lamp", 2.3, add_floor_lamp},
      {"bench", 1.5, [](Workshop s, T t) { add_bench(s, t, 1.5); }},
      {"reception", 6.0, add_reception},
      {"vending_machine", 2.3, add_vending_machine},
      {"kiosk", 1.9, add_kiosk},
      {"round_column", 5.3, [](Workshop s, T t) { add_round_column(s, t, 0.3, 5.0); }},
      {"square_column", 5.3, [](Workshop s, T t) { add_square_column(s, t, 0.5, 5.0); }},
      {"statue", 3.0, [](Workshop s, T t) { add_statue(s, t, 2.0); }},
      {"altar", 5.0, add_altar},
      {"urn", 1.6, add_urn},
      {"rubble", 4.0, [](Workshop s, T t) { add_rubble(s, t, 4); }},
      {"stele", 3.5, add_stele},
      {"picture", 2.0, add_picture},
      {"radiator", 1.5, [](Workshop s, T t) { add_radiator(s, t, 1.2); }},
      {"vent", 1.5, add_vent},
      {"extinguisher", 1.8, add_extinguisher},
      {"wall_box", 1.5, add_wall_box},
      {"sign", 1.0, add_sign},
      {"door_frame", 2.5, [](Workshop s, T t) { add_door_frame(s, t, 0.9, 2.1); }},
      {"ceiling_lamp", 1.0, add_ceiling_lamp},
      {"pendant_lamp", 2.0, [](Workshop s, T t) { add_pendant_lamp(s, t, 1.0); }},
      {"pipe_run", 4.5, [](Workshop s, T t) { add_pipe_run(s, t, 4.0); }},
      {"duct", 4.5, [](Workshop s, T t) { add_duct(s, t, 4.0); }},
      {"stairs", 8.0, [](Workshop s, T t) { add_stairs(s, t, 1.4, 3.0); }},
      {"railing", 4.5, [](Workshop s, T t) { add_railing(s, t, 4.0); }},
      {"crates", 6.0, [](Workshop s, T t) { add_crates(s, t, 6); }},
      {"barrel", 1.2, add_barrel},
      {"car", 3.5, add_car},
      {"rack", 5.5, [](Workshop s, T t) { add_rack(s, t, 6.0, 4.0); }},
      {"pallet", 6.0, add_pallet},
      {"ladder", 2.5, add_ladder},
      {"clutter", 3.0, add_clutter},
  };
  return all;
}

TriangleMesh build(const Piece& piece, std::uint64_t seed) {
  TriangleMesh mesh;
  Random random(seed);
  piece.add({mesh, random}, Eigen::Isometry3d::Identity());
  return mesh;
}

class EachPiece : public ::testing::TestWithParam<Piece> {};

// All pieces are closed solids, though they may overlap: their signed volume is above zero and
// does not depend on where it is measured from.
TEST_P(EachPiece, IsMadeOfClosedSolidsThatFaceOutwards) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const TriangleMesh mesh = build(GetParam(), seed);
    ASSERT_FALSE(mesh.triangles.empty());
    const auto volume = [&](const Eigen::Vector3d& origin) {
      double sum = 0.0;
      for (const auto& [a, b, c] : mesh.triangles) {
        sum += (mesh.vertices[a].cast<double>() - origin)
                   .dot((mesh.vertices[b].cast<double>() - origin)
                            .cross(mesh.vertices[c].cast<double>() - origin));
      }
      return sum / 6.0;
    };
    EXPECT_GT(volume({0, 0, 0}), 0.0) << "seed " << seed;
    EXPECT_NEAR(volume({0, 0, 0}), volume({2, 3, -4}), 2e-4) << "seed " << seed;
  }
}

TEST_P(EachPiece, StaysWithinReach) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    for (const Eigen::Vector3f& p : build(GetParam(), seed).vertices) {
      ASSERT_TRUE(p.allFinite());
      ASSERT_LT(p.norm(), GetParam().reach_m) << "seed " << seed;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, EachPiece, ::testing::ValuesIn(pieces()), [](const auto& piece) {
  return piece.param.name;
});

TEST(Furniture, ComesInManyShapes) {
  const Piece& sofa = pieces()[7];
  EXPECT_NE(build(sofa, 1).vertices.back(), build(sofa, 2).vertices.back());
  EXPECT_EQ(build(sofa, 1).vertices.back(), build(sofa, 1).vertices.back());
}

}  // namespace
}  // namespace landmarkdb::datasets
