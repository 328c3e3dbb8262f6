#include "engine/mono/refine_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace landmarkdb {
namespace {

constexpr double kLargestDamping = 1e8;
constexpr double kSmallestDamping = 1e-12;
constexpr double kFlat = 1e-9;    // relative decrease of the cost
constexpr double kStill = 1e-10;  // of the step, rad and m

// Cholesky's factor of the damped normal equations and the step -(H + damping diag H)^-1 g. False
// where the matrix is not positive definite.
bool solve_step(const PoseEquations& eq, double damping, std::array<double, 6>& step) {
  std::array<double, 21> L{};
  std::array<double, 6> inverse{};
  std::size_t row = 0;
  for (std::size_t i = 0; i < 6; row += ++i) {
    std::size_t other = 0;
    for (std::size_t k = 0; k <= i; other += ++k) {
      double sum = eq.H[row + k];
      if (k == i) sum += damping * sum;
      for (std::size_t j = 0; j < k; ++j) sum -= L[row + j] * L[other + j];
      if (k < i) {
        L[row + k] = sum * inverse[k];
        continue;
      }
      if (!(sum > 0.0)) return false;
      L[row + i] = std::sqrt(sum);
      inverse[i] = 1.0 / L[row + i];
    }
  }
  row = 0;
  for (std::size_t i = 0; i < 6; row += ++i) {
    double sum = -eq.g[i];
    for (std::size_t j = 0; j < i; ++j) sum -= L[row + j] * step[j];
    step[i] = sum * inverse[i];
  }
  for (std::size_t i = 6; i-- > 0;) {
    double sum = step[i];
    for (std::size_t j = i + 1; j < 6; ++j) sum -= L[j * (j + 1) / 2 + i] * step[j];
    step[i] = sum * inverse[i];
  }
  return true;
}

// R <- turn R by the unit quaternion along (1, w / 2), which is exp([w]x) to second order; no
// trigonometry, exactly a rotation.
RigidPose moved(const RigidPose& pose, const std::array<double, 6>& step) {
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(1.0, 0.5 * step[0], 0.5 * step[1], 0.5 * step[2]).normalized();
  return {turn.toRotationMatrix() * pose.R, pose.t + Eigen::Vector3d(step[3], step[4], step[5])};
}

bool evaluate(std::span<const PosePoint> points,
              std::span<const PoseEdge> edges,
              const Camera& camera,
              const RigidPose& pose,
              double huber,
              PoseEquations& equations) {
  equations.clear();
  return add_points(points, camera, pose, huber, equations) &&
         add_edges(edges, camera, pose, huber, equations) && std::isfinite(equations.cost);
}

}  // namespace

bool start_refinement(std::span<const PosePoint> points,
                      std::span<const PoseEdge> edges,
                      const Camera& camera,
                      const RigidPose& start,
                      const RefineOptions& options,
                      RefineState& state) {
  state.pose = start;
  state.damping = 1e-6;
  state.at_rest = false;
  return evaluate(points, edges, camera, start, options.huber, state.equations);
}

void refine_steps(std::span<const PosePoint> points,
                  std::span<const PoseEdge> edges,
                  const Camera& camera,
                  const RefineOptions& options,
                  int steps,
                  RefineState& state) {
  PoseEquations tried;
  std::array<double, 6> step{};
  for (int i = 0; i < steps && !state.at_rest; ++i) {
    for (;;) {
      bool better = false;
      double length = 0.0;
      RigidPose pose;
      if (solve_step(state.equations, state.damping, step)) {
        for (const double x : step) length = std::max(length, std::abs(x));
        pose = moved(state.pose, step);
        better = evaluate(points, edges, camera, pose, options.huber, tried) &&
                 tried.cost <= state.equations.cost;
      }
      if (better) {
        const double fall = state.equations.cost - tried.cost;
        state.at_rest = fall <= kFlat * state.equations.cost || length < kStill;
        state.pose = pose;
        state.equations = tried;
        state.damping = std::max(0.1 * state.damping, kSmallestDamping);
        break;
      }
      state.damping *= 10.0;
      if (length > 0.0 && length < kStill) state.at_rest = true;
      if (state.damping > kLargestDamping) state.at_rest = true;
      if (state.at_rest) break;
    }
  }
}

Eigen::Matrix<double, 6, 6> pose_covariance(const PoseEquations& equations) {
  const Eigen::Matrix<double, 6, 6> H = equations.matrix();
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factor(H);
  constexpr double kRank = 1e-13;  // smallest pivot against the largest
  const auto D = factor.vectorD();
  if (factor.info() != Eigen::Success || !(D.minCoeff() > kRank * D.maxCoeff())) {
    return Eigen::Matrix<double, 6, 6>::Zero();
  }
  const Eigen::Matrix<double, 6, 6> of_turn_first =
      factor.solve(Eigen::Matrix<double, 6, 6>::Identity());
  Eigen::Matrix<double, 6, 6> result;
  result.topLeftCorner<3, 3>() = of_turn_first.bottomRightCorner<3, 3>();
  result.bottomRightCorner<3, 3>() = of_turn_first.topLeftCorner<3, 3>();
  result.topRightCorner<3, 3>() = of_turn_first.bottomLeftCorner<3, 3>();
  result.bottomLeftCorner<3, 3>() = of_turn_first.topRightCorner<3, 3>();
  return result;
}

}  // namespace landmarkdb
