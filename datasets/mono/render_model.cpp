#include "datasets/mono/render_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "datasets/mono/surfaces.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr int kTile_px = 16;
constexpr double kBackground = 110.0;

// The rays of pixels: exact where asked, and for whole rows from a table every 8 pixels, good to
// 0.02 px, which only decides what is looked at more closely.
class Rays {
 public:
  explicit Rays(const Camera& camera) : camera_(camera) {
    columns_ = camera.width / kStep + 2;
    for (std::uint32_t v = 0; v <= camera.height / kStep + 1; ++v) {
      for (std::uint32_t u = 0; u < columns_; ++u) {
        const auto ray = undistort(camera, {double{kStep} * u, double{kStep} * v});
        table_.push_back(ray.value_or(Eigen::Vector2d::Constant(kNowhere)));
      }
    }
  }

  Eigen::Vector2d about(double u, double v) const {
    const auto column = static_cast<std::size_t>(u / kStep),
               row = static_cast<std::size_t>(v / kStep);
    const double a = u / kStep - static_cast<double>(column),
                 b = v / kStep - static_cast<double>(row);
    const Eigen::Vector2d* at = table_.data() + row * columns_ + column;
    return (1.0 - b) * ((1.0 - a) * at[0] + a * at[1]) +
           b * ((1.0 - a) * at[columns_] + a * at[columns_ + 1]);
  }
  std::optional<Eigen::Vector2d> at(double u, double v) const { return undistort(camera_, {u, v}); }
  static bool nowhere(const Eigen::Vector2d& ray) {
    return ray.cwiseAbs().maxCoeff() > 0.1 * kNowhere;
  }

 private:
  static constexpr std::uint32_t kStep = 8;
  static constexpr double kNowhere = 1e6;
  const Camera& camera_;
  std::size_t columns_ = 0;
  std::vector<Eigen::Vector2d> table_;
};

// Uneven light: a gradient, and waves of random direction where texture is asked for.
class Background {
 public:
  Background(const Camera& camera, const RenderOptions& options) : texture_(options.texture) {
    Random random(options.seed ^ 0xb6u);
    slope_ = Eigen::Vector2d(random.uniform(-30.0, 30.0) / camera.width,
                             random.uniform(-30.0, 30.0) / camera.height);
    for (Eigen::Vector3d& wave : waves_) {
      const double angle = random.uniform(0.0, 6.28), length_px = random.uniform(5.0, 40.0);
      wave = {6.28 * std::cos(angle) / length_px,
              6.28 * std::sin(angle) / length_px,
              random.uniform(0.0, 6.28)};
    }
  }

  double at(double u, double v) const {
    double grey = kBackground + slope_.x() * u + slope_.y() * v;
    if (texture_ > 0.0) {
      double sum = 0.0;
      for (const Eigen::Vector3d& wave : waves_)
        sum += std::sin(wave.dot(Eigen::Vector3d(u, v, 1.0)));
      grey += texture_ * sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
    }
    return grey;
  }

 private:
  double texture_;
  Eigen::Vector2d slope_;
  std::array<Eigen::Vector3d, 8> waves_;
};

class Renderer {
 public:
  Renderer(const std::vector<Surface>& surfaces, const Camera& camera, const RenderOptions& options)
      : surfaces_(surfaces),
        camera_(camera),
        options_(options),
        rays_(camera),
        background_(camera, options),
        first_(std::size_t{camera.width} * camera.height, -1) {}

  std::vector<double> render() {
    for (std::uint32_t v = 0; v < camera_.height; v += kTile_px) {
      for (std::uint32_t u = 0; u < camera_.width; u += kTile_px) cast_tile(u, v);
    }
    std::vector<double> grey(first_.size());
    for (std::uint32_t v = 0; v < camera_.height; ++v) {
      for (std::uint32_t u = 0; u < camera_.width; ++u) grey[index(u, v)] = pixel(u, v);
    }
    return grey;
  }

 private:
  std::size_t index(std::uint32_t u, std::uint32_t v) const {
    return std::size_t{v} * camera_.width + u;
  }

  // Which surfaces a tile may show, by their boxes and the tile's with a pixel or two around.
  void cast_tile(std::uint32_t u0, std::uint32_t v0) {
    constexpr double kAround = 2.0;
    const double u1 = std::min<double>(u0 + kTile_px, camera_.width),
                 v1 = std::min<double>(v0 + kTile_px, camera_.height);
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
    for (const double u : {u0 - kAround, u1 + kAround}) {
      for (const double v : {v0 - kAround, v1 + kAround}) {
        const Eigen::Vector2d ray = rays_.about(std::max(0.0, u), std::max(0.0, v));
        low = low.cwiseMin(ray);
        high = high.cwiseMax(ray);
      }
    }
    const Eigen::Vector2d margin = 0.25 * (high - low);
    std::vector<int>& among = tiles_.emplace_back();
    for (std::size_t i = 0; i < surfaces_.size(); ++i) {
      if ((surfaces_[i].high.array() < (low - margin).array()).any() ||
          (surfaces_[i].low.array() > (high + margin).array()).any()) {
        continue;
      }
      among.push_back(static_cast<int>(i));
    }
    if (among.empty()) return;
    for (std::uint32_t v = v0; v < v1; ++v) {
      for (std::uint32_t u = u0; u < u1; ++u) {
        const Eigen::Vector2d ray = rays_.about(u, v);
        if (!Rays::nowhere(ray)) first_[index(u, v)] = first_surface(surfaces_, among, ray);
      }
    }
  }

  const std::vector<int>& among(std::uint32_t u, std::uint32_t v) const {
    const std::uint32_t columns = (camera_.width + kTile_px - 1) / kTile_px;
    return tiles_[std::size_t{v / kTile_px} * columns + u / kTile_px];
  }

  double grey_of(int surface, double u, double v) const {
    return surface < 0 ? background_.at(u, v) : surfaces_[static_cast<std::size_t>(surface)].grey;
  }

  double pixel(std::uint32_t u, std::uint32_t v) const {
    const int here = first_[index(u, v)];
    bool even = true;
    for (std::uint32_t y = v > 0 ? v - 1 : 0; even && y <= std::min(v + 1, camera_.height - 1);
         ++y) {
      for (std::uint32_t x = u > 0 ? u - 1 : 0; x <= std::min(u + 1, camera_.width - 1); ++x) {
        even = even && first_[index(x, y)] == here;
      }
    }
    if (even) return grey_of(here, u, v);
    const std::optional<Eigen::Vector2d> middle = rays_.at(u, v);
    if (!middle) return background_.at(u, v);
    // Within a pixel the lens is linear: the table's slope, from the exact middle.
    const Eigen::Vector2d about = rays_.about(u, v);
    const Eigen::Vector2d along_u = rays_.about(u + 1.0, v) - about,
                          along_v = rays_.about(u, v + 1.0) - about;
    double sum = 0.0;
    for (int i = 0; i < options_.samples; ++i) {
      for (int j = 0; j < options_.samples; ++j) {
        const double a = (i + 0.5) / options_.samples - 0.5, b = (j + 0.5) / options_.samples - 0.5;
        const Eigen::Vector2d ray = *middle + a * along_u + b * along_v;
        sum += grey_of(first_surface(surfaces_, among(u, v), ray), u, v);
      }
    }
    return sum / (options_.samples * options_.samples);
  }

  const std::vector<Surface>& surfaces_;
  const Camera& camera_;
  const RenderOptions& options_;
  Rays rays_;
  Background background_;
  std::vector<int> first_;               // by pixel: the surface at its middle
  std::vector<std::vector<int>> tiles_;  // by tile: the surfaces it may show
};

}  // namespace

GreyImage render_models(std::span<const SeenModel> models,
                        const Camera& camera,
                        const RenderOptions& options) {
  std::vector<Surface> surfaces;
  add_clutter(camera, options, surfaces);
  std::uint64_t seed = options.seed;
  for (const SeenModel& seen : models) add_model(seen, options, ++seed, surfaces);
  const std::vector<double> grey = Renderer(surfaces, camera, options).render();
  GreyImage image{camera.width, camera.height, {}};
  image.pixels.reserve(grey.size());
  Random random(options.seed ^ 0x401u);
  for (const double value : grey) {
    const double noisy = value + (options.noise > 0.0 ? options.noise * random.normal() : 0.0);
    image.pixels.push_back(static_cast<std::uint8_t>(std::clamp(noisy + 0.5, 0.0, 255.0)));
  }
  return image;
}

GreyImage render_model(const MonoModel& model,
                       const Camera& camera,
                       const Eigen::Isometry3d& T_camera_object,
                       const RenderOptions& options) {
  const SeenModel seen{&model, T_camera_object};
  return render_models(std::span(&seen, 1), camera, options);
}

}  // namespace landmarkdb::datasets
