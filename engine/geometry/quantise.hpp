#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// Points as little-endian int16, x, y, z, six bytes a point: position = offset_m + scale_m * value.
// -32768 is left for what marks an invalid point on the wire.
struct QuantisedPoints {
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  double scale_m = 1.0;  // > 0
  std::string bytes;
};

// The finest that holds all of the points, which must be finite: off by 1/131,068 of their widest
// side at most, and by what float rounds.
QuantisedPoints quantise(std::span<const Eigen::Vector3f> points);

// The way back. Bytes that are no whole number of points are not looked at.
std::vector<Eigen::Vector3f> dequantise(const QuantisedPoints& quantised);

}  // namespace landmarkdb
