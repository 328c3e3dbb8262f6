#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landmarkdb {

// Estimates how a target moves from its measured poses: an alpha-beta filter with fading memory
// (Benedict & Bordner 1962, Brookner 1998), one for the position and one for the rotation.
//
// Constant speed is followed without lag. Not thread-safe.
class TargetObserver {
 public:
  // `memory`, 0 to below 1: 0 believes the last two measurements alone, 0.9 averages over some 20.
  explicit TargetObserver(double memory) : memory_(memory) {}

  // Takes in where the target is, `elapsed_s` after the last call.
  void update(const Eigen::Isometry3d& T_base_target, double elapsed_s);

  // Its velocity in the base frame: of its origin in m/s, and its turn in rad/s. Zero after fewer
  // than two measurements.
  const Eigen::Vector3d& velocity() const { return velocity_; }
  const Eigen::Vector3d& turn_rate() const { return turn_rate_; }

  // Where a target measured at `T_base_target` is `seconds` later.
  Eigen::Isometry3d carry(const Eigen::Isometry3d& T_base_target, double seconds) const;

  // Forgets everything, as after a jump.
  void reset();

 private:
  double memory_;
  int updates_ = 0;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rate_ = Eigen::Vector3d::Zero();
};

}  // namespace landmarkdb
