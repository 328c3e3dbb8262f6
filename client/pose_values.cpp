#include "client/pose_values.hpp"

#include <numbers>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json rotation_json(const Eigen::Matrix3d& R) {
  Eigen::Quaterniond q(R);
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();  // one of the two that mean the same
  return Json::array({q.x(), q.y(), q.z(), q.w()});
}

Eigen::Vector3d euler_zyx_deg(const Eigen::Matrix3d& R) {
  return roll_pitch_yaw_rad(R).reverse() * (180.0 / std::numbers::pi);
}

}  // namespace landmarkdb::client
