#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// The numbers of a segment as little-endian bytes, and back. The byte counts are multiples of the
// row's size (checked by the caller).
using Bytes = std::vector<std::byte>;

Bytes bytes_of(const std::vector<Eigen::Vector3f>& vectors);  // n x 3 float
Bytes bytes_of(const std::vector<std::uint16_t>& indices);
std::vector<Eigen::Vector3f> vectors_from(const Bytes& bytes);
std::vector<std::uint16_t> indices_from(const Bytes& bytes);

// Rotations as unit quaternions x, y, z, w with w >= 0. Throws Error{kInvalidArgument} beginning
// with `what` for a matrix that is no rotation (to 1e-2).
Bytes quaternions_of(const std::vector<Eigen::Matrix3f>& rotations, const std::string& what);
// Throws Error{kDataLoss} for a quaternion that is not of unit length (to 1e-3).
std::vector<Eigen::Matrix3f> frames_from(const Bytes& bytes, const std::string& what);

// IEEE 754 half precision, rounded to nearest even. A descriptor value is 0..1 and loses at most
// 2^-12 of itself (below 6e-5: 3e-8). Throws Error{kInvalidArgument} past the range of halves.
Bytes halves_of(const std::vector<float>& values, const std::string& what);
// Rows of `row_length` halves, each brought to unit length in double; a row of zeros stays so.
std::vector<float> unit_rows_from(const Bytes& bytes, std::size_t row_length);

}  // namespace landmarkdb
