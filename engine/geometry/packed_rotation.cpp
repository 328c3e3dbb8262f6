#include "engine/geometry/packed_rotation.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

constexpr double kScale = 32'767.0;

std::int16_t packed(double value) { return static_cast<std::int16_t>(std::lround(kScale * value)); }

}  // namespace

PackedRotation pack_rotation(const Eigen::Matrix3f& R) {
  Eigen::Quaterniond q(R.cast<double>());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return {packed(q.x()), packed(q.y()), packed(q.z()), packed(q.w())};
}

std::vector<PackedRotation> pack_rotations(std::span<const Eigen::Matrix3f> rotations) {
  std::vector<PackedRotation> all;
  all.reserve(rotations.size());
  for (const Eigen::Matrix3f& R : rotations) all.push_back(pack_rotation(R));
  return all;
}

Eigen::Matrix3f unpack_rotation(const PackedRotation& packed) {
  Eigen::Quaternionf q(static_cast<float>(packed[3]),
                       static_cast<float>(packed[0]),
                       static_cast<float>(packed[1]),
                       static_cast<float>(packed[2]));
  if (q.coeffs().isZero()) return Eigen::Matrix3f::Identity();
  q.normalize();
  return q.toRotationMatrix();
}

}  // namespace landmarkdb
