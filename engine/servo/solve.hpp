#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/servo/arm.hpp"

namespace landmarkdb {

struct PseudoInverseOptions {
  double cutoff = 1e-4;         // singular values below this share of the largest count as zero
  double damping = 0.05;        // reached as a singular value falls to zero, and
  double damping_below = 0.02;  // growing from nothing here (Maciejewski & Klein 1988)
};

// The pseudo-inverse of A by singular value decomposition, and what it leaves free.
//
// A direction with singular value s below `damping_below` is answered with s / (s^2 + d^2), where
// d^2 = damping^2 (1 - (s / damping_below)^2): no jump where damping begins, and the other
// directions stay exact. `free` is I - A^+ A of the undamped inverse.
struct PseudoInverse {
  Eigen::MatrixXd inverse;  // columns of A x rows of A
  Eigen::MatrixXd free;     // square, columns of A
  int rank = 0;
  double smallest = 0.0;  // smallest singular value that counts, 0 without any
  bool damped = false;
};
PseudoInverse pseudo_inverse(const Eigen::MatrixXd& A, const PseudoInverseOptions& options);

// What joints should do where more important tasks leave them free: rate z for the joints named,
// nothing for the others.
struct JointTask {
  std::vector<Eigen::Index> joints{};
  JointVector z{};  // rad/s, one number a joint of the arm
};

struct JointRates {
  JointVector rates;                     // rad/s
  int rank = 0;                          // of the main task, before any joint was clamped
  double smallest_singular = 0.0;        // of the main task
  bool damped = false;                   // near a singular pose
  double scale = 1.0;                    // all rates were slowed down by this factor
  std::vector<Eigen::Index> at_limit{};  // joints that were clamped, ascending
};

// Rates with J rates = wanted as well as can be, the joint tasks where that leaves freedom, most
// important first, and no joint past its range after `cycle_s`.
//
// A joint that would cross a limit is set to arrive there, and the others are solved again without
// it. When a joint would be faster than its largest rate, all are slowed down by one factor, so
// the path stays the same; a joint task never makes that factor smaller. A joint found past its
// limit is led back to it.
JointRates solve_rates(const Arm& arm,
                       const JointVector& q,
                       const Eigen::MatrixXd& J,
                       const Eigen::VectorXd& wanted,
                       std::span<const JointTask> joint_tasks,
                       double cycle_s,
                       const PseudoInverseOptions& options);

}  // namespace landmarkdb
