#include "engine/servo/solve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/SVD>

namespace landmarkdb {
namespace {

using Index = Eigen::Index;

double max_rate(const Arm& arm, Index joint) {
  return arm.joints[static_cast<std::size_t>(joint)].max_rate_rad_s;
}

// The factor that brings every joint under its largest rate.
double rate_scale(const Arm& arm, const JointVector& rates) {
  double scale = 1.0;
  for (Index i = 0; i < rates.size(); ++i) {
    const double fastest = max_rate(arm, i);
    if (std::abs(rates(i)) > fastest) scale = std::min(scale, fastest / std::abs(rates(i)));
  }
  return scale;
}

// How much of `extra` can be added before a joint is slower served than it was: 0 to 1.
double room_for(const Arm& arm, const JointVector& rates, const JointVector& extra) {
  double share = 1.0;
  for (Index i = 0; i < rates.size(); ++i) {
    const double most = std::max(std::abs(rates(i)), max_rate(arm, i));
    if (std::abs(rates(i) + extra(i)) <= most || extra(i) == 0.0) continue;
    const double room = std::copysign(most, extra(i)) - rates(i);
    share = std::min(share, room / extra(i));
  }
  return std::clamp(share, 0.0, 1.0);
}

// Which joints may still be chosen, and the rates of the others.
struct Clamped {
  std::vector<bool> fixed;
  JointVector rates;  // of the fixed ones; 0 elsewhere
};

// Main task, then joint tasks, over the joints that are not fixed. `main` receives the inverse of
// the main task.
JointVector solve_free(const Arm& arm,
                       const Eigen::MatrixXd& J,
                       const Eigen::VectorXd& wanted,
                       std::span<const JointTask> joint_tasks,
                       const Clamped& clamped,
                       const PseudoInverseOptions& options,
                       PseudoInverse& main) {
  const Index n = J.cols();
  Eigen::MatrixXd A = J;
  for (Index i = 0; i < n; ++i) {
    if (clamped.fixed[static_cast<std::size_t>(i)]) A.col(i).setZero();
  }
  main = pseudo_inverse(A, options);
  JointVector rates = clamped.rates + main.inverse * (wanted - J * clamped.rates);
  Eigen::MatrixXd free = main.free;
  for (Index i = 0; i < n; ++i) {
    if (!clamped.fixed[static_cast<std::size_t>(i)]) continue;
    free.row(i).setZero();
    free.col(i).setZero();
  }
  for (const JointTask& task : joint_tasks) {
    if (task.joints.empty()) continue;
    const JointVector extra = free * task.z;
    rates += room_for(arm, rates, extra) * extra;
    // What this task can move is no longer free for the next one.
    Eigen::MatrixXd rows(static_cast<Index>(task.joints.size()), n);
    for (std::size_t k = 0; k < task.joints.size(); ++k) {
      rows.row(static_cast<Index>(k)) = free.row(task.joints[k]);
    }
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinV);
    constexpr double kUsed = 1e-6;  // a projector's singular values are 0 or up to 1
    for (Index k = 0; k < svd.singularValues().size(); ++k) {
      if (svd.singularValues()(k) < kUsed) break;
      free -= svd.matrixV().col(k) * svd.matrixV().col(k).transpose();
    }
  }
  return rates;
}

// The joint that would be furthest past a limit, or -1.
Index worst_crossing(const Arm& arm,
                     const JointVector& q,
                     const JointVector& rates,
                     double cycle_s,
                     const std::vector<bool>& fixed) {
  constexpr double kRounding_rad = 1e-12;
  Index worst = -1;
  double furthest = kRounding_rad;
  for (Index i = 0; i < q.size(); ++i) {
    if (fixed[static_cast<std::size_t>(i)]) continue;
    const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
    const double next = q(i) + rates(i) * cycle_s;
    const double past = std::max(next - joint.max_rad, joint.min_rad - next);
    if (past > furthest) {
      furthest = past;
      worst = i;
    }
  }
  return worst;
}

// The rate that takes joint i to the limit it would cross.
double rate_to_limit(const Arm& arm, Index i, double q, double rate, double cycle_s) {
  const ArmJoint& joint = arm.joints[static_cast<std::size_t>(i)];
  const double limit = q + rate * cycle_s > joint.max_rad ? joint.max_rad : joint.min_rad;
  return std::clamp((limit - q) / cycle_s, -joint.max_rate_rad_s, joint.max_rate_rad_s);
}

}  // namespace

PseudoInverse pseudo_inverse(const Eigen::MatrixXd& A, const PseudoInverseOptions& options) {
  PseudoInverse result;
  result.inverse = Eigen::MatrixXd::Zero(A.cols(), A.rows());
  result.free = Eigen::MatrixXd::Identity(A.cols(), A.cols());
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& s = svd.singularValues();
  for (Index k = 0; k < s.size(); ++k) {
    if (!(s(k) > 0.0) || s(k) < options.cutoff * s(0)) break;
    const double ratio = s(k) / options.damping_below;
    double gain = 1.0 / s(k);
    if (ratio < 1.0) {
      gain = s(k) / (s(k) * s(k) + options.damping * options.damping * (1.0 - ratio * ratio));
      result.damped = true;
    }
    result.inverse += gain * svd.matrixV().col(k) * svd.matrixU().col(k).transpose();
    result.free -= svd.matrixV().col(k) * svd.matrixV().col(k).transpose();
    result.rank = static_cast<int>(k) + 1;
    result.smallest = s(k);
  }
  return result;
}

JointRates solve_rates(const Arm& arm,
                       const JointVector& q,
                       const Eigen::MatrixXd& J,
                       const Eigen::VectorXd& wanted,
                       std::span<const JointTask> joint_tasks,
                       double cycle_s,
                       const PseudoInverseOptions& options) {
  const Index n = q.size();
  assert(J.cols() == n && J.rows() == wanted.size() && "a column a joint, a row a wanted number");
  Clamped clamped{std::vector<bool>(static_cast<std::size_t>(n), false), JointVector::Zero(n)};
  JointRates result;
  for (Index round = 0; round <= n; ++round) {
    PseudoInverse main;
    result.rates = solve_free(arm, J, wanted, joint_tasks, clamped, options, main);
    if (round == 0) {
      result.rank = main.rank;
      result.smallest_singular = main.smallest;
      result.damped = main.damped;
    }
    result.scale = rate_scale(arm, result.rates);
    result.rates *= result.scale;
    const Index joint = worst_crossing(arm, q, result.rates, cycle_s, clamped.fixed);
    if (joint < 0) break;
    clamped.fixed[static_cast<std::size_t>(joint)] = true;
    clamped.rates(joint) = rate_to_limit(arm, joint, q(joint), result.rates(joint), cycle_s);
  }
  for (Index i = 0; i < n; ++i) {
    if (clamped.fixed[static_cast<std::size_t>(i)]) result.at_limit.push_back(i);
  }
  return result;
}

}  // namespace landmarkdb
