#include "server/servo_symmetry.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

MonoModel turned_four_times_about(const Eigen::Vector3d& axis) {
  MonoModel model;
  model.symmetry_class = "c4";
  model.diameter_m = 0.1;
  for (int i = 0; i < 4; ++i) {
    Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = Eigen::AngleAxisd(i * 1.5707963267948966, axis).toRotationMatrix();
    model.symmetries.push_back(T);
  }
  return model;
}

TEST(ServoSymmetry, IsTheModelsWhereItTurnsAboutZ) {
  MonoModel model = turned_four_times_about(Eigen::Vector3d::UnitZ());
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "c4");
  model.symmetries[1](0, 3) = 0.05;  // about an axis beside the origin
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "none");
}

TEST(ServoSymmetry, IsNoneAboutAnotherAxisOrOfAnotherGroup) {
  MonoModel model = turned_four_times_about(Eigen::Vector3d::UnitX());
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "none");
  model.symmetry_class = "cube";
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "none");
  EXPECT_EQ(to_string(servo_symmetry_of(MonoModel{})), "none");
}

TEST(ServoSymmetry, OfRevolutionOnlyRoundZ) {
  MonoModel model;
  model.symmetry_class = "revolution";
  model.diameter_m = 0.1;
  model.circles = {{Eigen::Vector3d(0, 0, 0.1), Eigen::Vector3d::UnitZ(), 0.05}};
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "revolution");
  model.circles[0].center.x() = 0.02;
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "none");
  model.circles[0] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitY(), 0.05};
  EXPECT_EQ(to_string(servo_symmetry_of(model)), "none");
}

}  // namespace
}  // namespace landmarkdb
