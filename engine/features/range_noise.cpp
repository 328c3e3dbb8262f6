#include "engine/features/range_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "engine/base/parallel.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/cloud/gathered_points.hpp"
#include "engine/features/sensor_ray.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kBlock = 256;  // points between two looks at the stop request
constexpr std::size_t kFewestOfBin = 50;
constexpr double kMostWider = 3.0;  // times the normals' radius: the widest neighbourhood looked at
constexpr double kFlattest = 0.25;  // share of a bin's points that are taken for planar

// What a neighbourhood scatters about a surface that bends: a quadric over the plane fitted.
// Infinite where there are too few points for one.
float scatter_about_quadric(const GatheredPoints& around,
                            const ScatterPlane& plane,
                            const Eigen::Vector3f& at,
                            float radius_m) {
  constexpr std::size_t kParameters = 6;
  constexpr std::size_t kFewest = 2 * kParameters;
  if (!std::isfinite(plane.sigma_m)) return std::numeric_limits<float>::infinity();
  using Vector6d = Eigen::Matrix<double, kParameters, 1>;
  Eigen::Matrix<double, kParameters, kParameters> A =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Vector6d b = Vector6d::Zero();
  double squares = 0.0;
  std::size_t found = 0;
  const Eigen::Vector3f right = plane.normal.unitOrthogonal();
  const Eigen::Vector3f up = plane.normal.cross(right);
  for (std::size_t i = 0; i < around.size(); ++i) {
    const Eigen::Vector3f p = around.point(i);
    if (!((p - at).squaredNorm() < radius_m * radius_m)) continue;
    ++found;
    const Eigen::Vector3f d = (p - plane.mean) / radius_m;
    const auto x = static_cast<double>(right.dot(d));
    const auto y = static_cast<double>(up.dot(d));
    const auto z = static_cast<double>(plane.normal.dot(d));
    Vector6d row;
    row << 1.0, x, y, x * x, x * y, y * y;
    A.noalias() += row * row.transpose();
    b += z * row;
    squares += z * z;
  }
  if (found < kFewest) return std::numeric_limits<float>::infinity();
  const double left = squares - b.dot(A.ldlt().solve(b));
  return radius_m * static_cast<float>(
                        std::sqrt(std::max(left, 0.0) / static_cast<double>(found - kParameters)));
}

std::size_t bin_of(double first_range_m, float range_m) {
  if (!(range_m > first_range_m)) return 0;
  return static_cast<std::size_t>(std::log(static_cast<double>(range_m) / first_range_m) /
                                  std::log(RangeNoise::kStep));
}

struct Bin {
  double sigma_m = 0.0;
  double weight = 0.0;  // points
  std::size_t bins = 1;
};

// Wide enough to hold several of the sheets that a depth camera's quantised disparity leaves of a
// far wall.
float noise_radius_m(double radius_m, float range_m) {
  constexpr float kOfRange = 0.05F;
  const auto least = static_cast<float>(radius_m);
  return std::clamp(kOfRange * range_m, least, static_cast<float>(kMostWider) * least);
}

// Points of each bin of range, spread over all that it has: a quantile of some hundreds is as good
// as that of thousands.
std::vector<std::vector<std::uint32_t>> sample_bins(const PreparedCloud& cloud,
                                                    double first_range_m) {
  constexpr std::size_t kEnoughOfBin = 250;
  std::vector<std::vector<std::uint32_t>> bins;
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    const std::size_t bin = bin_of(first_range_m, ray_to(cloud, i).range_m);
    if (bin >= bins.size()) bins.resize(bin + 1);
    bins[bin].push_back(i);
  }
  for (std::vector<std::uint32_t>& bin : bins) {
    const std::size_t all = bin.size();
    const std::size_t kept = std::min(all, kEnoughOfBin);
    for (std::size_t k = 0; k < kept; ++k) bin[k] = bin[k * all / kept];
    bin.resize(kept);
  }
  return bins;
}

// How far the neighbourhoods of these points scatter about planes, along their rays; about bent
// surface, along its normal. Those that have none are left out.
std::vector<float> scatter_of(const PreparedCloud& cloud,
                              const CellGrid& grid,
                              std::span<const std::uint32_t> sample,
                              double radius_m,
                              SurfaceShape shape,
                              const RunContext& context) {
  std::vector<float> sigma(sample.size());
  parallel_chunks(sample.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    GatheredPoints around;
    for (std::size_t k = begin; k < end; ++k) {
      if ((k - begin) % kBlock == 0) context.check("preprocess");
      const bool bent = shape == SurfaceShape::kBent;
      const SensorRay ray = ray_to(cloud, sample[k]);
      const float radius =
          bent ? static_cast<float>(radius_m) : noise_radius_m(radius_m, ray.range_m);
      const Eigen::Vector3f& at = cloud.points[sample[k]];
      around.gather(grid, at, radius);
      const ScatterPlane plane = around.fit_plane(at, radius);
      sigma[k] = bent ? scatter_about_quadric(around, plane, at, radius)
                      : plane.sigma_m / ray.steepness(plane.normal);
    }
  });
  std::erase_if(sigma, [](float value) { return !std::isfinite(value); });
  return sigma;
}

// Noise does not fall with the range: the nearest sequence that never falls (pool adjacent
// violators: Barlow et al. 1972), each bin weighted by its points.
std::vector<float> never_falling(const std::vector<Bin>& measured) {
  std::vector<Bin> pools;
  for (Bin next : measured) {
    while (!pools.empty() && pools.back().sigma_m >= next.sigma_m) {
      const Bin& last = pools.back();
      const double weight = last.weight + next.weight;
      if (weight > 0.0) {
        next.sigma_m = (last.sigma_m * last.weight + next.sigma_m * next.weight) / weight;
      }
      next.weight = weight;
      next.bins += last.bins;
      pools.pop_back();
    }
    pools.push_back(next);
  }
  std::vector<float> sigma_m;
  for (const Bin& pool : pools) {
    sigma_m.insert(sigma_m.end(), pool.bins, static_cast<float>(pool.sigma_m));
  }
  return sigma_m;
}

}  // namespace

float RangeNoise::at(float range_m) const {
  if (sigma_m.empty()) return 0.0F;
  return sigma_m[std::min(bin_of(first_range_m, range_m), sigma_m.size() - 1)];
}

RangeNoise measure_range_noise(const PreparedCloud& cloud,
                               double radius_m,
                               const RunContext& context,
                               SurfaceShape shape) {
  RangeNoise noise;
  noise.first_range_m = 10.0 * cloud.resolution_m;
  if (cloud.viewpoints.empty()) return noise;
  const CellGrid grid(cloud.points, radius_m);
  std::vector<std::vector<float>> bins;
  for (const std::vector<std::uint32_t>& sample : sample_bins(cloud, noise.first_range_m)) {
    bins.push_back(scatter_of(cloud, grid, sample, radius_m, shape, context));
  }
  std::vector<Bin> measured;
  for (std::vector<float>& bin : bins) {
    // Of too few points: as the bin before it.
    const double before = measured.empty() ? 0.0 : measured.back().sigma_m;
    measured.push_back({before, static_cast<double>(bin.size())});
    if (bin.size() < kFewestOfBin) continue;
    const auto at =
        bin.begin() + static_cast<std::ptrdiff_t>(kFlattest * static_cast<double>(bin.size()));
    std::nth_element(bin.begin(), at, bin.end());
    measured.back().sigma_m = static_cast<double>(*at);
  }
  noise.sigma_m = never_falling(measured);
  return noise;
}

std::vector<float> range_weights(const PreparedCloud& cloud, const RangeNoise& noise, float left) {
  std::vector<float> weights(cloud.size(), 1.0F);
  if (noise.sigma_m.empty()) return weights;
  constexpr double kHalf = 0.3;  // of the resolution: an error of which a point counts for half
  const auto half = static_cast<float>(kHalf * cloud.resolution_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const SensorRay ray = ray_to(cloud, i);
    const float ratio = left * noise.at(ray.range_m) * ray.steepness(cloud.normals[i]) / half;
    weights[i] = 1.0F / (1.0F + ratio * ratio);
  }
  return weights;
}

}  // namespace landmarkdb
