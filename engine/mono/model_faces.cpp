#include "engine/mono/model_faces.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace landmarkdb {
namespace {

Eigen::Vector3d mean_corner(const MonoModel& model, std::span<const std::uint32_t> face) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t corner : face) mean += model.points[corner].xyz;
  return mean / static_cast<double>(std::max<std::size_t>(face.size(), 1));
}

}  // namespace

Eigen::Vector3d area_vector(const MonoModel& model, std::span<const std::uint32_t> face) {
  const Eigen::Vector3d middle = mean_corner(model, face);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Eigen::Vector3d a = model.points[face[i]].xyz - middle;
    const Eigen::Vector3d b = model.points[face[(i + 1) % face.size()]].xyz - middle;
    sum += a.cross(b);
  }
  return sum;
}

Eigen::Vector3d area_centroid(const MonoModel& model, std::span<const std::uint32_t> face) {
  const Eigen::Vector3d middle = mean_corner(model, face);
  const Eigen::Vector3d normal = area_vector(model, face).normalized();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    const Eigen::Vector3d a = model.points[face[i]].xyz - middle;
    const Eigen::Vector3d b = model.points[face[(i + 1) % face.size()]].xyz - middle;
    const double part = a.cross(b).dot(normal);  // signed: dents count against
    weighted += part * (a + b) / 3.0;
    area += part;
  }
  return area > 0.0 ? Eigen::Vector3d(middle + weighted / area) : middle;
}

Eigen::Matrix3d area_spread(const MonoModel& model, std::span<const std::uint32_t> face) {
  const Eigen::Vector3d middle = mean_corner(model, face);
  const Eigen::Vector3d normal = area_vector(model, face).normalized();
  const Eigen::Vector3d off = area_centroid(model, face) - middle;
  Eigen::Matrix3d weighted = Eigen::Matrix3d::Zero();
  double area = 0.0;
  for (std::size_t i = 0; i < face.size(); ++i) {
    // The triangle of the middle and a side.
    const Eigen::Vector3d a = model.points[face[i]].xyz - middle;
    const Eigen::Vector3d b = model.points[face[(i + 1) % face.size()]].xyz - middle;
    const double part = a.cross(b).dot(normal);
    weighted +=
        part / 12.0 * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose());
    area += part;
  }
  if (!(area > 0.0)) return Eigen::Matrix3d::Zero();
  return weighted / area - off * off.transpose();
}

double out_of_plane_m(const MonoModel& model, std::span<const std::uint32_t> face) {
  const Eigen::Vector3d middle = mean_corner(model, face);
  const Eigen::Vector3d normal = area_vector(model, face).normalized();
  double furthest = 0.0;
  for (const std::uint32_t corner : face) {
    furthest = std::max(furthest, std::abs((model.points[corner].xyz - middle).dot(normal)));
  }
  return furthest;
}

}  // namespace landmarkdb
