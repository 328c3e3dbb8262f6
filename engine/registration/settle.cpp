#include "engine/registration/settle.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "engine/registration/plane_pairs.hpp"
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
  const std::span<const Eigen::Vector3f> points = test.points().first(n);
  for (const Eigen::Vector3f& p : points) mean += p;
  mean /= static_cast<float>(n);
  for (const Eigen::Vector3f& p : points) moved.spread_m2 += (p - mean).squaredNorm();
  moved.spread_m2 /= static_cast<float>(n);
  moved.centre = R * mean + t;
  return moved;
}

}  // namespace

void settle_pose(const SurfaceGrid& target,
                 const TestPoints& test,
                 const SettleOptions& options,
                 Eigen::Matrix3f& R_target_source,
                 Eigen::Vector3f& t_target_source) {
  const PointGroups& all = test.groups();
  const std::size_t groups = std::min(PointGroups::groups_for(options.points), all.groups());
  if (groups == 0) return;
  const std::size_t n = all.size_of(groups);
  constexpr std::size_t kFewestPairs = 8;
  // As if this share of the points held every freedom where it is: what the surface does not fix
  // does not drift.
  constexpr float kHold = 0.02F;
  const double sigma_m = static_cast<double>(options.sigma_cells) * target.cell_m();
  Moved moved = moved_centre(test, n, R_target_source, t_target_source);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const PlaneSums sums = pair_and_sum(target,
                                        all,
                                        groups,
                                        {R_target_source, t_target_source},
                                        {.factor = PairFactor::kGraded, .centre = moved.centre},
                                        PlaneSummer(PairWeight::kGaussian, sigma_m));
    if (sums.pairs < kFewestPairs) return;
    Matrix6f A = sums.A.cast<float>();
    const float hold = kHold * static_cast<float>(n);
    A.diagonal().head<3>().array() += hold;
    A.diagonal().tail<3>().array() += hold * moved.spread_m2;
    const Vector6f x = A.ldlt().solve(sums.b.cast<float>());
    const float angle = x.tail<3>().norm();
    if (!x.allFinite()) return;
    const Eigen::Matrix3f turn =
        angle > 1e-6F ? Eigen::AngleAxisf(angle, x.tail<3>() / angle).toRotationMatrix()
                      : Eigen::Matrix3f::Identity();
    t_target_source = turn * (t_target_source - moved.centre) + moved.centre + x.head<3>();
    R_target_source = turn * R_target_source;
    moved.centre += x.head<3>();
  }
}

}  // namespace landmarkdb
