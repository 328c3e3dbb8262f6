#include "engine/geometry/quantise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

constexpr double kLargest = 32767.0;
constexpr std::size_t kBytesAPoint = 6;

}  // namespace

QuantisedPoints quantise(std::span<const Eigen::Vector3f> points) {
  QuantisedPoints out;
  if (points.empty()) return out;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point : points) box.extend(point.cast<double>());
  out.offset_m = box.center();
  const double half_m = 0.5 * box.sizes().maxCoeff();
  if (half_m > 0.0) out.scale_m = half_m / kLargest;
  out.bytes.reserve(points.size() * kBytesAPoint);
  for (const Eigen::Vector3f& point : points) {
    for (const double number : (point.cast<double>() - out.offset_m) / out.scale_m) {
      const auto rounded =
          static_cast<std::int16_t>(std::lround(std::clamp(number, -kLargest, kLargest)));
      const auto bits = static_cast<std::uint16_t>(rounded);
      out.bytes += static_cast<char>(bits & 0xFFU);
      out.bytes += static_cast<char>(bits >> 8U);
    }
  }
  return out;
}

std::vector<Eigen::Vector3f> dequantise(const QuantisedPoints& quantised) {
  std::vector<Eigen::Vector3f> points(quantised.bytes.size() / kBytesAPoint);
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint16_t>(static_cast<unsigned char>(quantised.bytes[i]));
  };
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = kBytesAPoint * i + 2 * k;
      const auto value = static_cast<std::int16_t>(byte(at) | byte(at + 1) << 8U);
      const auto axis = static_cast<Eigen::Index>(k);
      points[i](axis) = static_cast<float>(quantised.offset_m(axis) + quantised.scale_m * value);
    }
  }
  return points;
}

}  // namespace landmarkdb
