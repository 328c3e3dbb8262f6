#include "datasets/depth_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Eigenvalues>

#include "datasets/ray_noise.hpp"
#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kNoDepth = 0.0F;
// The first Kinect: focal length and baseline of camera and projector (Khoshelham, Elberink 2012),
// disparity in eighths of a pixel.
constexpr double kKinectFocal_px = 580.0;
constexpr double kKinectBaseline_m = 0.075;
constexpr double kDisparityStep_px = 0.125;
// Neighbouring pixels further apart than this share of their depth lie on two surfaces.
constexpr float kEdgeShare = 0.06F;

void check(const DepthCameraOptions& options) {
  constexpr std::uint64_t kMaxPixels = 16'000'000;
  const Camera& camera = options.camera;
  const std::uint64_t pixels = std::uint64_t{camera.width} * camera.height;
  if (pixels == 0 || pixels > kMaxPixels) {
    throw Error(ErrorCode::kInvalidArgument,
                "depth camera: " + std::to_string(camera.width) + " x " +
                    std::to_string(camera.height) + " pixels, want 1 to 16,000,000 in all");
  }
  if (!(camera.fx > 0.0 && camera.fy > 0.0)) {
    throw Error(ErrorCode::kInvalidArgument, "depth camera: the focal length must be positive");
  }
  if (std::any_of(camera.dist.begin(), camera.dist.end(), [](double k) { return k != 0.0; })) {
    throw Error(ErrorCode::kInvalidArgument, "depth camera: lens distortion is not simulated");
  }
}

// True depth and surface normal of every pixel; kNoDepth where the camera cannot see any.
struct TrueImage {
  std::vector<float> depth;
  std::vector<Eigen::Vector3f> normal;  // scene frame
};

// The ray of pixel i with z = 1, camera frame.
Eigen::Vector3f pixel_ray(const Camera& camera, std::size_t i) {
  return {static_cast<float>((static_cast<double>(i % camera.width) - camera.cx) / camera.fx),
          static_cast<float>((static_cast<double>(i / camera.width) - camera.cy) / camera.fy),
          1.0F};
}

TrueImage cast(const Place& place,
               const Eigen::Isometry3f& T_scene_camera,
               const DepthCameraOptions& options,
               int threads) {
  const std::size_t pixels = std::size_t{options.camera.width} * options.camera.height;
  TrueImage image{std::vector<float>(pixels, kNoDepth), std::vector<Eigen::Vector3f>(pixels)};
  const Eigen::Vector3f eye = T_scene_camera.translation();
  const Eigen::Vector3f projector =
      T_scene_camera * Eigen::Vector3f(static_cast<float>(kKinectBaseline_m), 0.0F, 0.0F);
  const auto grazing = static_cast<float>(std::sin(options.grazing_rad));
  parallel_chunks(pixels, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Eigen::Vector3f ray = pixel_ray(options.camera, i);
      const float length = ray.norm();
      const Eigen::Vector3f direction = T_scene_camera.linear() * ray / length;
      const auto hit =
          place.caster->first_hit(eye, direction, static_cast<float>(options.max_range_m) * length);
      if (!hit || !hit->returns_light || !hit->front_face) continue;
      const float z = hit->distance_m / length;
      if (z < options.min_range_m || std::abs(hit->normal.dot(direction)) < grazing) continue;
      const Eigen::Vector3f p = eye + hit->distance_m * direction;
      if (options.shadows && place.caster->blocked(projector, p + 2e-3F * hit->normal)) continue;
      image.depth[i] = z;
      image.normal[i] = hit->normal;
    }
  });
  return image;
}

bool beside_edge(const TrueImage& image, const Camera& camera, std::size_t i) {
  const float z = image.depth[i];
  const auto differs = [&](std::size_t j) { return std::abs(image.depth[j] - z) > kEdgeShare * z; };
  const std::size_t column = i % camera.width;
  const std::size_t row = i / camera.width;
  return (column > 0 && differs(i - 1)) || (column + 1 < camera.width && differs(i + 1)) ||
         (row > 0 && differs(i - camera.width)) ||
         (row + 1 < camera.height && differs(i + camera.width));
}

// The depth the camera reports where the truth is `z`.
double measure(double z, const DepthCameraOptions& options, Random& random) {
  constexpr double kLeastNoiseAt_m = 0.4;
  const double away = z - kLeastNoiseAt_m;
  const double sigma = options.noise_floor_m + options.noise_growth * away * away;
  const double noisy = z + options.noise_scale * sigma * random.normal();
  if (!options.quantise || !(noisy > 0.0)) return noisy;
  const double fb = kKinectFocal_px * kKinectBaseline_m;
  const double steps = std::round(fb / noisy / kDisparityStep_px);
  return steps > 0.0 ? fb / (steps * kDisparityStep_px) : 0.0;
}

double normal_spread(const TrueImage& image) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  std::size_t count = 0;
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    if (image.depth[i] == kNoDepth) continue;
    const Eigen::Vector3d n = image.normal[i].cast<double>();
    sum += n * n.transpose();
    ++count;
  }
  if (count == 0) return 0.0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(sum / static_cast<double>(count));
  return std::max(0.0, solver.eigenvalues()[0]);
}

}  // namespace

DepthFrame render_depth(const Place& place,
                        const Eigen::Isometry3d& T_scene_camera,
                        const DepthCameraOptions& options,
                        const RunContext& context) {
  check(options);
  context.check("render");
  const TrueImage image = cast(place, T_scene_camera.cast<float>(), options, context.threads);
  DepthFrame frame;
  frame.T_scene_camera = T_scene_camera;
  frame.up_camera = T_scene_camera.linear().transpose() * place.up;
  frame.normal_spread = normal_spread(image);
  frame.cloud.width = options.camera.width;
  frame.cloud.height = options.camera.height;
  frame.cloud.viewpoints = {Eigen::Vector3f::Zero()};
  frame.cloud.points.assign(image.depth.size(), Eigen::Vector3f::Constant(kNaN));
  parallel_chunks(image.depth.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (image.depth[i] == kNoDepth) continue;
      Random random = ray_random(options.seed, i);
      if (beside_edge(image, options.camera, i) && random.uniform() < options.edge_holes) continue;
      const double z = measure(image.depth[i], options, random);
      if (!(z >= options.min_range_m && z <= options.max_range_m)) continue;
      frame.cloud.points[i] = static_cast<float>(z) * pixel_ray(options.camera, i);
    }
  });
  frame.valid = static_cast<std::size_t>(std::count_if(
      frame.cloud.points.begin(), frame.cloud.points.end(), [](const Eigen::Vector3f& p) {
        return std::isfinite(p.z());
      }));
  return frame;
}

}  // namespace landmarkdb::datasets
