#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

namespace landmarkdb {

// A pinhole camera with the plumb_bob lens model. Pixels; `dist` is k1, k2, p1, p2, k3.
struct Camera {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  std::array<double, 5> dist{};
  double depth_scale = 0.0;  // raw units per metre of a depth image; 0: not given
};

}  // namespace landmarkdb
