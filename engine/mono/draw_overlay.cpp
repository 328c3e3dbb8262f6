#include "engine/mono/draw_overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

#include <Eigen/Geometry>
#include <png.h>

#include "engine/base/error.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour kBest{40, 220, 60};
constexpr Colour kOther{70, 140, 255};
constexpr Colour kMissed{255, 60, 50};
constexpr Colour kUnused{170, 170, 90};

class Painter {
 public:
  Painter(const GreyImage& image, const Camera& camera) : camera_(camera) {
    width_ = static_cast<int>(image.width);
    height_ = static_cast<int>(image.height);
    pixels_.reserve(image.pixels.size() * 3);
    for (const std::uint8_t grey : image.pixels) {
      for (int c = 0; c < 3; ++c) pixels_.push_back(grey);
    }
  }

  // Where a point of the camera frame is seen; nothing behind the camera or where the lens model
  // ends.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_camera) const {
    constexpr double kNearest_m = 1e-6;
    if (p_camera.z() < kNearest_m) return std::nullopt;
    const Eigen::Vector2d ray(p_camera.x() / p_camera.z(), p_camera.y() / p_camera.z());
    const Eigen::Vector2d uv = distort(camera_, ray);
    if (!uv.allFinite()) return std::nullopt;
    const auto back = undistort(camera_, uv);
    constexpr double kSameRay = 1e-3;
    if (!back || (*back - ray).norm() > kSameRay) return std::nullopt;
    return uv;
  }

  void dot(const Eigen::Vector2d& uv, const Colour& colour) {
    const Eigen::Vector2d at = uv.array().round();
    // Written so that far and not finite places are left out before they become integers.
    if (!(at.x() >= 0.0 && at.x() < width_ && at.y() >= 0.0 && at.y() < height_)) return;
    const std::size_t index =
        3 * (static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(width_) +
             static_cast<std::size_t>(at.x()));
    std::copy(colour.begin(), colour.end(), pixels_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  void ring(const Eigen::Vector2d& uv, double radius_px, const Colour& colour) {
    constexpr int kSteps = 32;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSteps;
      dot(uv + radius_px * Eigen::Vector2d(std::cos(angle), std::sin(angle)), colour);
    }
  }

  void cross(const Eigen::Vector2d& uv, const Colour& colour) {
    constexpr int kArm = 4;
    for (int i = -kArm; i <= kArm; ++i) {
      dot(uv + Eigen::Vector2d(i, i), colour);
      dot(uv + Eigen::Vector2d(i, -i), colour);
    }
  }

  std::string png() const {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(width_);
    header.height = static_cast<png_uint_32>(height_);
    header.format = PNG_FORMAT_RGB;
    png_alloc_size_t size = 0;
    if (png_image_write_get_memory_size(header, size, 0, pixels_.data(), 0, nullptr) == 0) fail();
    std::string bytes(size, '\0');
    if (png_image_write_to_memory(&header, bytes.data(), &size, 0, pixels_.data(), 0, nullptr) ==
        0) {
      fail();
    }
    bytes.resize(size);
    return bytes;
  }

 private:
  [[noreturn]] static void fail() {
    throw Error(ErrorCode::kInternal, "the overlay could not be made a PNG file");
  }

  const Camera& camera_;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> pixels_{};
};

class ModelDrawing {
 public:
  ModelDrawing(Painter& painter, const OverlayModel& drawn, const Colour& colour)
      : painter_(painter),
        model_(*drawn.model),
        hypothesis_(*drawn.hypothesis),
        colour_(colour),
        visibility_(*drawn.model),
        eye_(drawn.hypothesis->T_camera_object.inverse().translation()) {}

  void lines() {
    for (const auto& [a, b] : model_.edges) {
      const Eigen::Vector3d from = model_.points[a].xyz;
      const Eigen::Vector3d way = model_.points[b].xyz - from;
      curve([&](double s) { return Eigen::Vector3d(from + s * way); });
    }
    for (const ModelCircle& circle : model_.circles) {
      const Eigen::Vector3d u = circle.normal.unitOrthogonal() * circle.radius_m;
      const Eigen::Vector3d v = circle.normal.cross(u);
      curve([&](double s) {
        const double angle = 2.0 * std::numbers::pi * s;
        return Eigen::Vector3d(circle.center + std::cos(angle) * u + std::sin(angle) * v);
      });
    }
  }

  void points(const ImageFeatures& features) {
    constexpr double kRing_px = 5.0;
    std::vector<bool> matched(model_.points.size(), false);
    for (const MonoPair& pair : hypothesis_.pairs) {
      if (pair.model < matched.size()) matched[pair.model] = true;
      if (pair.image < features.points.size()) {
        painter_.ring(features.points[pair.image].uv, kRing_px, colour_);
      }
    }
    const std::vector<bool> seen = visibility_.points_from(eye_);
    for (std::size_t i = 0; i < model_.points.size(); ++i) {
      if (matched[i] || !seen[i]) continue;
      const auto uv = painter_.project(hypothesis_.T_camera_object * model_.points[i].xyz);
      if (uv) painter_.cross(*uv, kMissed);
    }
  }

 private:
  // A dot a pixel, about; `at` runs from 0 to 1.
  template <typename At>
  void curve(const At& at) {
    constexpr int kCoarse = 16;
    constexpr int kMostDots = 8192;
    double length_px = 0.0;
    Eigen::Vector2d last = Eigen::Vector2d::Zero();
    bool has_last = false;
    for (int i = 0; i <= kCoarse; ++i) {
      const auto uv = painter_.project(hypothesis_.T_camera_object * at(i / double{kCoarse}));
      if (uv && has_last) length_px += (*uv - last).norm();
      has_last = uv.has_value();
      if (uv) last = *uv;
    }
    const int dots = std::clamp(static_cast<int>(std::min(length_px, 1e6) * 1.5), 2, kMostDots);
    for (int i = 0; i <= dots; ++i) {
      const Eigen::Vector3d place = at(i / static_cast<double>(dots));
      if (!visibility_.place_seen_from(place, eye_)) continue;
      if (const auto uv = painter_.project(hypothesis_.T_camera_object * place)) {
        painter_.dot(*uv, colour_);
      }
    }
  }

  Painter& painter_;
  const MonoModel& model_;
  const MonoHypothesis& hypothesis_;
  Colour colour_;
  ModelVisibility visibility_;
  Eigen::Vector3d eye_;
};

}  // namespace

std::string draw_overlay(const GreyImage& image,
                         const ImageFeatures& features,
                         const Camera& camera,
                         const std::vector<OverlayModel>& models) {
  Painter painter(image, camera);
  for (const ImageFeature& feature : features.points) {
    constexpr double kDot_px = 1.0;
    painter.ring(feature.uv, kDot_px, kUnused);
  }
  for (std::size_t i = models.size(); i-- > 0;) {  // the best on top
    ModelDrawing drawing(painter, models[i], i == 0 ? kBest : kOther);
    drawing.lines();
    if (i == 0) drawing.points(features);
  }
  return painter.png();
}

}  // namespace landmarkdb
