#include "engine/registration/settle.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "engine/registration/plane_sums.hpp"

namespace landmarkdb {

namespace {

using Matrix6f = Eigen::Matrix<float, 6, 6>;
using Vector6f = Eigen::Matrix<float, 6, 1>;

struct Moved {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  // of the points, target frame
  float spread_m2 = 0.0F;                            // mean squared distance from it
};

Moved moved_centre(const TestPoints& test,
                   std::size_t n,
                   const Eigen::Matrix3f& R,
                   const Eigen::Vector3f& t) {
  Moved moved;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < n; ++i) mean += test.points[i];
  mean /= static_cast<float>(n);
  for (std::size_t i = 0; i < n; ++i) moved.spread_m2 += (test.points[i] - mean).squaredNorm();
  moved.spread_m2 /= static_cast<float>(n);
  moved.centre = R * mean + t;
  return moved;
}

// The normal equations of (translation, rotation about `centre`).
PlaneSums accumulate(const SurfaceGrid& target,
                     const TestPoints& test,
                     std::size_t n,
                     double sigma_m,
                     const Eigen::Matrix3f& R,
                     const Eigen::Vector3f& t,
                     const Eigen::Vector3f& centre) {
  PlaneSummer summer(PairWeight::kGaussian, sigma_m);
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f p = R * test.points[i] + t;
    const Surfel& surfel = target.near_or_none(p);
    const float agreement = std::max(surfel.normal.dot(R * test.normals[i]), 0.0F);
    summer.add(surfel.normal, p - centre, surfel.normal.dot(p - surfel.point), agreement);
  }
  return summer.finish();
}

}  // namespace

void settle_pose(const SurfaceGrid& target,
                 const TestPoints& test,
                 const SettleOptions& options,
                 Eigen::Matrix3f& R_target_source,
                 Eigen::Vector3f& t_target_source) {
  const std::size_t n = std::min(options.points, test.size());
  constexpr std::size_t kFewestPairs = 8;
  // As if this share of the points held every freedom where it is: what the surface does not fix
  // does not drift.
  constexpr float kHold = 0.02F;
  const double sigma_m = static_cast<double>(options.sigma_cells) * target.cell_m();
  Moved moved = moved_centre(test, n, R_target_source, t_target_source);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const PlaneSums sums =
        accumulate(target, test, n, sigma_m, R_target_source, t_target_source, moved.centre);
    if (sums.pairs < kFewestPairs) return;
    Matrix6f A = sums.A.cast<float>();
    const float hold = kHold * static_cast<float>(n);
    A.diagonal().head<3>().array() += hold;
    A.diagonal().tail<3>().array() += hold * moved.spread_m2;
    const Vector6f x = A.ldlt().solve(sums.b.cast<float>());
    const float angle = x.tail<3>().norm();
    if (!std::isfinite(angle)) return;
    const Eigen::Matrix3f turn =
        angle > 1e-6F ? Eigen::AngleAxisf(angle, x.tail<3>() / angle).toRotationMatrix()
                      : Eigen::Matrix3f::Identity();
    t_target_source = turn * (t_target_source - moved.centre) + moved.centre + x.head<3>();
    R_target_source = turn * R_target_source;
    moved.centre += x.head<3>();
  }
}

}  // namespace landmarkdb
