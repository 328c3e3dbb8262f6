#include "engine/servo/target_observer.hpp"

#include <algorithm>
#include <cassert>

#include "engine/geometry/pose.hpp"
#include "engine/servo/task.hpp"

namespace landmarkdb {

Eigen::Isometry3d TargetObserver::carry(const Eigen::Isometry3d& T_base_target,
                                        double seconds) const {
  Eigen::Isometry3d later = T_base_target;
  later.linear() = rotation_from_vector(turn_rate_ * seconds) * T_base_target.linear();
  later.translation() += velocity_ * seconds;
  return later;
}

void TargetObserver::update(const Eigen::Isometry3d& T_base_target, double elapsed_s) {
  assert(elapsed_s > 0.0 && "time goes on between two measurements");
  ++updates_;
  if (updates_ == 1) {
    pose_ = T_base_target;
    return;
  }
  // Growing memory at first (the least-squares line through all measurements), then fading memory:
  // alpha = 1 - m^2, beta = (1 - m)^2 (Brookner 1998, 1.4).
  const double k = updates_;
  const double alpha = std::max(2.0 * (2.0 * k - 1.0) / (k * (k + 1.0)), 1.0 - memory_ * memory_);
  const double beta = std::max(6.0 / (k * (k + 1.0)), (1.0 - memory_) * (1.0 - memory_));
  const Eigen::Isometry3d expected = carry(pose_, elapsed_s);
  const Eigen::Vector3d off = T_base_target.translation() - expected.translation();
  const Eigen::Vector3d turn =
      rotation_vector(T_base_target.linear() * expected.linear().transpose());
  pose_.translation() = expected.translation() + std::min(alpha, 1.0) * off;
  pose_.linear() = rotation_from_vector(std::min(alpha, 1.0) * turn) * expected.linear();
  velocity_ += std::min(beta, 1.0) / elapsed_s * off;
  turn_rate_ += std::min(beta, 1.0) / elapsed_s * turn;
}

void TargetObserver::reset() { *this = TargetObserver(memory_); }

}  // namespace landmarkdb
