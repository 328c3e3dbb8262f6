#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace landmarkdb::bench {

// One column of the Monte Carlo of poses: errors of a method against the truth.
struct PoseColumn {
  std::string points;  // "general n=4" and so on
  std::string method;  // "bound" (the minimum that the true pose leads to) or "ours"
  double turn_deg = 0.0, turn_p95_deg = 0.0;
  double shift_mm = 0.0, shift_p95_mm = 0.0;  // medians and 95th percentiles
  double wrong = 0.0;                         // share over 15 degrees off, or failed
  double wrong_unsaid = 0.0;  // of these, not told as ambiguous with the right pose beside it
  double us = 0.0;            // a pose
};

// Points within 0.1 m of the object's origin, half a pixel of noise, f 600 px, 0.8 to 1.2 m away.
std::vector<PoseColumn> run_poses(std::size_t poses, std::uint64_t seed);

}  // namespace landmarkdb::bench
