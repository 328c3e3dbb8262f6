#include "engine/mono/model_symmetry.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using testing::box_json;
using testing::read_text;
using ::testing::SizeIs;

std::string class_of(const std::string& json) {
  return read_text(json, "a.json").model.symmetry_class;
}

std::string points_json(const std::vector<Eigen::Vector3d>& points) {
  std::string text = "{\"points\": [";
  for (const auto& p : points) {
    if (text.back() != '[') text += ',';
    text += "[" + std::to_string(p.x()) + "," + std::to_string(p.y()) + "," +
            std::to_string(p.z()) + "]";
  }
  return text + "]}";
}

TEST(ModelSymmetry, NamesTheGroupsOfPolyhedra) {
  EXPECT_EQ(class_of(box_json()), "d2");
  std::vector<Eigen::Vector3d> cube;
  for (int i = 0; i < 8; ++i) {
    cube.emplace_back(i & 1 ? 0.1 : -0.1, i & 2 ? 0.1 : -0.1, i & 4 ? 0.1 : -0.1);
  }
  EXPECT_EQ(class_of(points_json(cube)), "cube");
  EXPECT_EQ(class_of(points_json({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}})),
            "tetrahedron");
  std::vector<Eigen::Vector3d> icosahedron;
  const double phi = std::numbers::phi;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-phi, phi}) {
      icosahedron.insert(icosahedron.end(), {{0, a, b}, {a, b, 0}, {b, 0, a}});
    }
  }
  EXPECT_EQ(class_of(points_json(icosahedron)), "icosahedron");
  // A pyramid over a pentagon, a prism over a triangle, and nothing regular.
  std::vector<Eigen::Vector3d> pyramid{{0, 0, 0.2}};
  for (int k = 0; k < 5; ++k) {
    pyramid.emplace_back(0.1 * std::cos(k * 1.2566370614), 0.1 * std::sin(k * 1.2566370614), 0);
  }
  EXPECT_EQ(class_of(points_json(pyramid)), "c5");
  std::vector<Eigen::Vector3d> prism;
  for (int k = 0; k < 3; ++k) {
    for (const double z : {-0.15, 0.15}) {
      prism.emplace_back(0.1 * std::cos(k * 2.0943951024), 0.1 * std::sin(k * 2.0943951024), z);
    }
  }
  EXPECT_EQ(class_of(points_json(prism)), "d3");
  EXPECT_EQ(class_of(points_json({{0, 0, 0}, {0.1, 0, 0}, {0, 0.2, 0}, {0, 0, 0.3}})), "none");
}

TEST(ModelSymmetry, AMarkOnAFaceBreaksIt) {
  EXPECT_EQ(class_of(box_json(
                R"(, "circles": [{"center":[0.06,0.04,0.06],"normal":[0,0,1],"radius":0.01}])")),
            "c2");
  EXPECT_EQ(class_of(box_json(
                R"(, "circles": [{"center":[0.03,0.04,0.06],"normal":[0,0,1],"radius":0.01}])")),
            "none");
}

TEST(ModelSymmetry, NeverTakesAMirrorForATurn) {
  // A wedge with one plane of mirror symmetry and no turn.
  EXPECT_EQ(class_of(points_json({{0, 0.1, 0}, {0, -0.1, 0}, {0.2, 0, 0}, {0.1, 0, 0.15}})),
            "none");
}

TEST(ModelSymmetry, EverySymmetryMapsTheModelOntoItself) {
  const MonoModel model = read_text(box_json(), "box.json").model;
  ASSERT_THAT(model.symmetries, SizeIs(4));
  EXPECT_EQ(model.symmetries[0], Eigen::Matrix4d::Identity());
  for (const Eigen::Matrix4d& T : model.symmetries) {
    EXPECT_LT(symmetry_error_m(model, T), 1e-12);
    EXPECT_NEAR((T.topLeftCorner<3, 3>().determinant()), 1.0, 1e-12);
  }
}

TEST(ModelSymmetry, CirclesOnOneAxisAreARevolution) {
  const auto bodies = [](double second_radius, double second_normal) {
    return R"({"circles": [{"center":[0,0,0],"normal":[0,0,-1],"radius":0.03},
               {"center":[0,0,0.1],"normal":[0,0,)" +
           std::to_string(second_normal) + R"(],"radius":)" + std::to_string(second_radius) + "}]}";
  };
  const MonoModel can = read_text(bodies(0.03, 1), "can.json").model;
  EXPECT_EQ(can.symmetry_class, "revolution");
  EXPECT_THAT(can.symmetries, SizeIs(2));  // the half turn that swaps the ends
  EXPECT_THAT(read_text(bodies(0.02, 1), "cup.json").model.symmetries, SizeIs(1));
  EXPECT_THAT(read_text(bodies(0.03, -1), "pipe.json").model.symmetries, SizeIs(1));
}

TEST(ModelSymmetry, AListThatIsNoGroupIsOther) {
  MonoModel model;
  const auto turn = [](double rad, const Eigen::Vector3d& axis) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = Eigen::AngleAxisd(rad, axis).toRotationMatrix();
    return T;
  };
  model.symmetries = {turn(0, {0, 0, 1}), turn(1.0, {0, 0, 1}), turn(2.0, {1, 0, 0})};
  EXPECT_EQ(symmetry_class(model), "other");
}

}  // namespace
}  // namespace landmarkdb
