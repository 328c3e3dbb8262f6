#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

namespace landmarkdb::bench {

// A pose is right when it is this near the truth (retrieval is judged so throughout).
inline constexpr double kRightMetres = 0.10;
inline constexpr double kRightDegrees = 5.0;

// How far an estimated pose of the camera is from the true one, in the camera's own axes: x right,
// y down, z forward; pitch about x, yaw about y, roll about z (the rotation vector's components).
struct PoseError {
  std::array<double, 3> xyz_mm{};
  std::array<double, 3> pitch_yaw_roll_deg{};
  double metres = 0.0;
  double degrees = 0.0;
  bool right() const { return metres <= kRightMetres && degrees <= kRightDegrees; }
};

PoseError pose_error(const Eigen::Isometry3d& truth, const Eigen::Isometry3d& estimate);

// What a method made of N frames.
struct ErrorTally {
  std::size_t asked = 0;
  std::size_t ambiguous = 0;
  std::vector<PoseError> right;
  std::vector<PoseError> wrong_ones;  // answered, but not right
  std::vector<double> milliseconds;   // of every frame asked

  // Mean absolute error over the frames that were localized, right or wrong, as the paper has it;
  // order x, y, z, pitch, yaw, roll. Zeros when there is none.
  std::array<double, 6> mean_absolute() const;
};

double median(std::vector<double> values);  // 0 of none

}  // namespace landmarkdb::bench
