#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

namespace landmarkdb::client {

// x, y, z.
nlohmann::ordered_json vector_json(const Eigen::Vector3d& v);

// A rotation as the unit quaternion x, y, z, w with w >= 0.
nlohmann::ordered_json rotation_json(const Eigen::Matrix3d& R);

// The angles about z, y and x, in degrees, that make up a rotation: R = Rz Ry Rx.
Eigen::Vector3d euler_zyx_deg(const Eigen::Matrix3d& R);

}  // namespace landmarkdb::client
