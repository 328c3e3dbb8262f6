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
// k1, k2, p1, p2, k3. `fy` is negative where the image's rows run upwards (some frame grabbers).
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

// Where a direction (x, y at z = 1) is seen: the lens model and the camera matrix, in pixels. A
// direction beyond the fold of the lens model (see inside_lens_model) gets a pixel that sees
// another one too.
Eigen::Vector2d distort(const Camera& camera, const Eigen::Vector2d& ray);

// The same with the derivative of the pixel by the direction.
struct LensPoint {
  Eigen::Vector2d uv;
  Eigen::Matrix2d duv_dray;
};
LensPoint distort_with_slope(const Camera& camera, const Eigen::Vector2d& ray);

// Whether the distorted radius still grows up to this direction. With k1 < 0 alone it turns back at
// r = 1 / sqrt(-3 k1), where it is (2/3) / sqrt(-3 k1): a lens model says nothing beyond.
bool inside_lens_model(const Camera& camera, const Eigen::Vector2d& ray);

// Where a point of the camera's frame (metres) is seen, in pixels; nullopt behind the camera and
// outside the lens model. The image's border is not looked at.
std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_camera);

// Whether the pixel lies within the image, centres of the outer pixels included.
bool in_image(const Camera& camera, const Eigen::Vector2d& uv);

// The direction (x, y at z = 1) that pixel `uv` sees: the inverse of distort, by Newton's method to
// the last digit. nullopt outside the lens model: beyond its fold, or where it does not converge.
// Such a point is refused, never moved to the rim.
std::optional<Eigen::Vector2d> undistort(const Camera& camera, const Eigen::Vector2d& uv);

}  // namespace landmarkdb
