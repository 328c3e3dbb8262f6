#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>

namespace landmarkdb {

// A pinhole camera with the plumb_bob lens model. Pixels, their centres at whole numbers; `dist` is
// k1, k2, p1, p2, k3.
struct Camera {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
  std::array<double, 5> dist{};
  double depth_scale = 0.0;  // raw units per metre of a depth image; 0: not given
};

// Reads a camera file: YAML in the OpenCV or ROS camera_info form (width or image_width, height or
// image_height, camera_matrix, distortion_model, distortion_coefficients, depth_scale), or JSON
// {width, height, fx, fy, cx, cy, dist, depth_scale}. Other keys are skipped.
//
// Throws Error{kInvalidArgument} that names the file, the key, what was seen and what was wanted.
Camera read_camera(const std::filesystem::path& path);

// The same for a file that is in memory; `name` is what messages call it.
Camera parse_camera(const std::string& text, std::string_view name);

// Where a direction (x, y at z = 1) is seen: the lens model and the camera matrix, in pixels.
Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& ray);

// The direction (x, y at z = 1) that pixel `uv` sees: the inverse of distort, by iteration. nullopt
// where it does not converge, which happens outside the range the lens was calibrated in.
std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& uv);

}  // namespace landmarkdb
