#include "engine/registration/icp.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "engine/geometry/pose.hpp"
#include "engine/registration/gyration.hpp"
#include "engine/registration/plane_pairs.hpp"

namespace landmarkdb {

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

// What the pose of one step pairs; points are told from `centre` (target frame).
PlaneSums accumulate(const SurfaceGrid& target,
                     const PointGroups& source,
                     const Eigen::Isometry3d& T,
                     const Eigen::Vector3d& centre,
                     double scale_m,
                     double min_agreement) {
  return pair_and_sum(target,
                      source,
                      source.groups(),
                      {T.linear().cast<float>(), T.translation().cast<float>()},
                      {.factor = PairFactor::kWhole,
                       .min_agreement = static_cast<float>(min_agreement),
                       .centre = centre.cast<float>()},
                      PlaneSummer(PairWeight::kGemanMcClure, scale_m));
}

// Solves A x = b in the directions that A fixes; the others stay at zero. `length` brings rotation
// to the scale of translation, so that one threshold serves both.
Vector6d solve_observable(const Matrix6d& A, const Vector6d& b, double length) {
  constexpr double kRelative =
      1e-4;  // eigenvalue against the largest: below, the surface says nothing
  Vector6d s;
  s << 1.0, 1.0, 1.0, 1.0 / length, 1.0 / length, 1.0 / length;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(s.asDiagonal() * A * s.asDiagonal());
  const Vector6d scaled = s.asDiagonal() * b;
  Vector6d x = Vector6d::Zero();
  for (int i = 0; i < 6; ++i) {
    const double value = solver.eigenvalues()(i);
    if (value <= kRelative * solver.eigenvalues()(5)) continue;
    x += solver.eigenvectors().col(i) * (solver.eigenvectors().col(i).dot(scaled) / value);
  }
  return s.asDiagonal() * x;
}

}  // namespace

IcpResult refine_icp(const SurfaceGrid& target,
                     std::span<const Eigen::Vector3f> source,
                     std::span<const Eigen::Vector3f> source_normals,
                     const Eigen::Isometry3d& T_target_source,
                     const IcpOptions& options) {
  const Gyration gyration = measure_gyration(source);
  const Eigen::Vector3d centre_source = gyration.centre;
  const double length = std::max(gyration.radius_m, 1e-9);
  const double cell = target.cell_m();
  IcpResult result;
  result.T_target_source = T_target_source;
  double scale_cells = options.start_scale_cells;
  // Until its steps are short some hundreds of points show the way as well as all.
  constexpr std::size_t kEnoughOnTheWay = 800;
  constexpr double kShort = 3.0;  // times a step that it stops at
  constexpr int kAtLeast = 8;     // iterations with all points, where the steps stay long
  const std::size_t stride = source.size() / kEnoughOnTheWay;
  const PointGroups all(source, source_normals);
  const PointGroups fewer =
      stride > 1 ? PointGroups(source, source_normals, stride) : PointGroups();
  bool with_all = stride <= 1;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    Eigen::Isometry3d& T = result.T_target_source;
    const Eigen::Vector3d centre = T * centre_source;
    const bool at_end = scale_cells <= options.end_scale_cells * 1.001;
    const PlaneSums sum = accumulate(target,
                                     with_all ? all : fewer,
                                     T,
                                     centre,
                                     scale_cells * cell,
                                     options.min_normal_agreement);
    if (sum.pairs < 6) break;
    const Vector6d x = solve_observable(sum.A, sum.b, length);
    T.linear() = nearest_rotation(rotation_from_vector(x.tail<3>()) * T.linear());
    T.translation() = centre + x.head<3>() - T.linear() * centre_source;
    const double step = std::max(x.head<3>().norm() / (options.stop_translation_cells * cell),
                                 x.tail<3>().norm() / options.stop_rotation_rad);
    if (at_end && with_all && step < 1.0) {
      result.converged = true;
      break;
    }
    with_all =
        with_all || (at_end && step < kShort) || iteration + kAtLeast >= options.max_iterations;
    constexpr double kAnneal = 0.8;  // per iteration: from start to end in about six
    scale_cells = std::max(options.end_scale_cells, scale_cells * kAnneal);
  }
  result.centre_target = result.T_target_source * centre_source;
  const PlaneSums final_sum = accumulate(target,
                                         all,
                                         result.T_target_source,
                                         result.centre_target,
                                         options.end_scale_cells * cell,
                                         options.min_normal_agreement);
  result.information = final_sum.A;
  if (final_sum.weight > 0.0) {
    result.noise_m2 = final_sum.squared_m2 / final_sum.weight;
    result.rmse_m = std::sqrt(result.noise_m2);
  }
  if (!source.empty()) {
    result.paired = static_cast<double>(final_sum.pairs) / static_cast<double>(source.size());
  }
  return result;
}

}  // namespace landmarkdb
