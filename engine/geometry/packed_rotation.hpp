#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// A rotation in eight bytes: its unit quaternion x, y, z, w with w >= 0, each times 32,767. Off by
// 1e-4 rad at most.
using PackedRotation = std::array<std::int16_t, 4>;

PackedRotation pack_rotation(const Eigen::Matrix3f& R);
std::vector<PackedRotation> pack_rotations(std::span<const Eigen::Matrix3f> rotations);

// The nearest rotation; the identity for one of four zeros, which no rotation is packed into.
Eigen::Matrix3f unpack_rotation(const PackedRotation& packed);

}  // namespace landmarkdb
