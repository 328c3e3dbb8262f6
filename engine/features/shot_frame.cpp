#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/features/shot_kernel.hpp"
#include "engine/features/shot_share.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMinPoints = 5;  // PCL's
constexpr int kMiddlePoints = 5;       // that decide a tie

Eigen::Vector3d offset(const Neighbourhood& points, std::size_t i) {
  return {static_cast<double>(points.x[i]),
          static_cast<double>(points.y[i]),
          static_cast<double>(points.z[i])};
}

Eigen::Matrix3d weighted_scatter(const Neighbourhood& points, float radius_m) {
  double xx = 0.0;
  double xy = 0.0;
  double xz = 0.0;
  double yy = 0.0;
  double yz = 0.0;
  double zz = 0.0;
  double weights = 0.0;
  for (std::size_t i = 0; i < points.count; ++i) {
    const double weight =
        static_cast<double>(radius_m) - std::sqrt(static_cast<double>(points.squared_m2[i]));
    const double x = static_cast<double>(points.x[i]);
    const double y = static_cast<double>(points.y[i]);
    const double z = static_cast<double>(points.z[i]);
    xx += weight * x * x;
    xy += weight * x * y;
    xz += weight * x * z;
    yy += weight * y * y;
    yz += weight * y * z;
    zz += weight * z * z;
    weights += weight;
  }
  Eigen::Matrix3d scatter;
  scatter << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return scatter / weights;
}

// As many points lie on either side: the five of middle distance decide.
bool middle_points_agree(const Neighbourhood& points, const Eigen::Vector3d& axis) {
  std::vector<std::size_t> order(points.count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto nearer = [&](std::size_t a, std::size_t b) {
    return points.squared_m2[a] != points.squared_m2[b]
               ? points.squared_m2[a] < points.squared_m2[b]
               : a < b;
  };
  const auto middle = static_cast<std::ptrdiff_t>(points.count / 2);
  const auto last = std::min(order.begin() + middle + kMiddlePoints / 2 + 1, order.end());
  std::partial_sort(order.begin(), last, order.end(), nearer);
  const auto first = std::max(last - kMiddlePoints, order.begin());
  const auto ahead =
      std::count_if(first, last, [&](std::size_t i) { return offset(points, i).dot(axis) > 0.0; });
  return ahead >= kMiddlePoints / 2 + 1;
}

// `axis` or its opposite, whichever has more points ahead of it.
Eigen::Vector3d towards_most(const Neighbourhood& points, const Eigen::Vector3d& axis) {
  std::size_t ahead = 0;
  for (std::size_t i = 0; i < points.count; ++i) {
    ahead += offset(points, i).dot(axis) >= 0.0 ? 1U : 0U;
  }
  const bool keep =
      2 * ahead == points.count ? middle_points_agree(points, axis) : 2 * ahead > points.count;
  return keep ? axis : -axis;
}

}  // namespace

void Neighbourhood::reserve(std::size_t size) {
  size = (size + kShotLanes - 1) / kShotLanes * kShotLanes;
  if (x.size() >= size) return;
  for (auto* array : {&x, &y, &z, &nx, &ny, &nz, &squared_m2}) array->resize(size);
}

bool shot_frame(const Neighbourhood& points, float radius_m, Eigen::Matrix3f& R_cloud_lrf) {
  if (points.count < kMinPoints) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(weighted_scatter(points, radius_m));
  if (!solver.eigenvalues().allFinite()) return false;
  const Eigen::Vector3d x = towards_most(points, solver.eigenvectors().col(2));
  const Eigen::Vector3d z = towards_most(points, solver.eigenvectors().col(0));
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  R_cloud_lrf = axes.cast<float>();
  return R_cloud_lrf.allFinite();
}

}  // namespace landmarkdb
