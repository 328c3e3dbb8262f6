#include "engine/registration/settle.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

using Matrix6f = Eigen::Matrix<float, 6, 6>;
using Vector6f = Eigen::Matrix<float, 6, 1>;

struct Step {
  Matrix6f A = Matrix6f::Zero();
  Vector6f b = Vector6f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  float spread_m2 = 0.0F;
  std::size_t pairs = 0;
};

// The normal equations of (translation, rotation about the moved points' centre).
Step accumulate(const SurfaceGrid& target,
                const TestPoints& test,
                std::size_t n,
                float factor,
                const Eigen::Matrix3f& R,
                const Eigen::Vector3f& t) {
  Step step;
  for (std::size_t i = 0; i < n; ++i) step.centre += test.points[i];
  step.centre = R * (step.centre / static_cast<float>(n)) + t;
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f p = R * test.points[i] + t;
    step.spread_m2 += (p - step.centre).squaredNorm();
    const Surfel* surfel = target.near(p);
    if (surfel == nullptr) continue;
    const float agreement = surfel->normal.dot(R * test.normals[i]);
    if (agreement <= 0.0F) continue;
    const float distance = surfel->normal.dot(p - surfel->point);
    const float weight = agreement * std::exp(factor * distance * distance);
    Vector6f J;
    J << surfel->normal, (p - step.centre).cross(surfel->normal);
    step.A.selfadjointView<Eigen::Lower>().rankUpdate(J, weight);
    step.b -= weight * distance * J;
    ++step.pairs;
  }
  step.spread_m2 /= static_cast<float>(n);
  return step;
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
  const float sigma = options.sigma_cells * target.cell_m();
  const float factor = -0.5F / (sigma * sigma);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    Step step = accumulate(target, test, n, factor, R_target_source, t_target_source);
    if (step.pairs < kFewestPairs) return;
    const float hold = kHold * static_cast<float>(n);
    step.A.diagonal().head<3>().array() += hold;
    step.A.diagonal().tail<3>().array() += hold * step.spread_m2;
    const Vector6f x = step.A.selfadjointView<Eigen::Lower>().ldlt().solve(step.b);
    const float angle = x.tail<3>().norm();
    if (!std::isfinite(angle)) return;
    const Eigen::Matrix3f turn =
        angle > 1e-6F ? Eigen::AngleAxisf(angle, x.tail<3>() / angle).toRotationMatrix()
                      : Eigen::Matrix3f::Identity();
    t_target_source = turn * (t_target_source - step.centre) + step.centre + x.head<3>();
    R_target_source = turn * R_target_source;
  }
}

}  // namespace landmarkdb
