#include "tests/support/servo_arms.hpp"

#include <array>
#include <numbers>

namespace landmarkdb::testing {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

struct Row {
  double a_m, alpha_deg, d_m, min_deg, max_deg;
};

Arm make_arm(const std::array<Row, 6>& rows, double max_rate_rad_s) {
  Arm arm;
  for (const Row& row : rows) {
    arm.joints.push_back({.a_m = row.a_m,
                          .alpha_rad = row.alpha_deg * kDegree,
                          .d_m = row.d_m,
                          .min_rad = row.min_deg * kDegree,
                          .max_rad = row.max_deg * kDegree,
                          .max_rate_rad_s = max_rate_rad_s});
  }
  arm.T_flange_camera = Eigen::Translation3d(0.05, 0.0, 0.08) *
                        Eigen::AngleAxisd(15.0 * kDegree, Eigen::Vector3d::UnitZ());
  return arm;
}

JointVector degrees(std::array<double, 6> angles) {
  return Eigen::Map<const JointVector>(angles.data(), 6) * kDegree;
}

}  // namespace

Arm puma_560(double max_rate_rad_s) {
  return make_arm({{{0.0, 90.0, 0.0, -160.0, 160.0},
                    {0.4318, 0.0, 0.0, -45.0, 225.0},
                    {0.0203, -90.0, 0.15005, -225.0, 45.0},
                    {0.0, 90.0, 0.4318, -110.0, 170.0},
                    {0.0, -90.0, 0.0, -100.0, 100.0},
                    {0.0, 0.0, 0.0, -266.0, 266.0}}},
                  max_rate_rad_s);
}

Arm small_arm(double max_rate_rad_s) {
  return make_arm({{{0.05, -90.0, 0.40, -150.0, 150.0},
                    {0.28, 0.0, 0.0, -200.0, 20.0},
                    {0.03, -90.0, 0.0, -60.0, 150.0},
                    {0.0, 90.0, 0.26, -160.0, 160.0},
                    {0.0, -90.0, 0.0, -110.0, 110.0},
                    {0.0, 0.0, 0.075, -190.0, 190.0}}},
                  max_rate_rad_s);
}

JointVector puma_560_pose() { return degrees({0.0, 45.0, -180.0, 0.0, 60.0, 0.0}); }
JointVector small_arm_pose() { return degrees({10.0, -80.0, 20.0, 15.0, -60.0, 30.0}); }

Eigen::Isometry3d wanted_pose() {
  return Eigen::Translation3d(0.0, 0.0, 0.6) *
         Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
}

Camera arm_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.dist[0] = -0.25;
  return camera;
}

}  // namespace landmarkdb::testing
