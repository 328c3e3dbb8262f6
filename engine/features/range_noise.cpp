#include "engine/features/range_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/base/parallel.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "engine/features/cell_grid.hpp"

namespace landmarkdb {
namespace {

constexpr double kCellsPerRadius = 1.0;  // the radii looked at are up to three times as large
constexpr std::size_t kBlock = 256;      // points between two looks at the stop request
constexpr std::size_t kFewestOfBin = 50;
constexpr double kMostWider = 3.0;  // times the normals' radius: the widest neighbourhood looked at
constexpr double kFlattest = 0.25;  // share of a bin's points that are taken for planar

struct PlaneFit {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  float sigma_m = std::numeric_limits<float>::infinity();
};

PlaneFit fit_plane(const CellGrid& grid,
                   const Eigen::Vector3f& at,
                   float radius_m,
                   std::vector<CellGrid::Found>& found) {
  constexpr std::size_t kFewest = 6;
  PlaneFit fit;
  grid.within(at, radius_m, found);
  if (found.size() < kFewest) return fit;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
  for (const CellGrid::Found& f : found) {
    const Eigen::Vector3f d = grid.point(f.place) - at;
    mean += d;
    squares.noalias() += d * d.transpose();
  }
  const auto n = static_cast<float>(found.size());
  mean /= n;
  const Eigen::Matrix3f covariance = squares / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(covariance);
  fit.mean = at + mean;
  fit.normal = solver.eigenvectors().col(0);
  fit.sigma_m = std::sqrt(std::max(solver.eigenvalues()(0), 0.0F));
  if (!fit.normal.allFinite()) fit.sigma_m = std::numeric_limits<float>::infinity();
  return fit;
}

// What a neighbourhood scatters about a surface that bends: a quadric over the plane fitted.
// Infinite where there are too few points for one.
float scatter_about_quadric(const CellGrid& grid,
                            const PlaneFit& plane,
                            std::span<const CellGrid::Found> found,
                            float radius_m) {
  constexpr std::size_t kParameters = 6;
  constexpr std::size_t kFewest = 2 * kParameters;
  if (found.size() < kFewest || !std::isfinite(plane.sigma_m)) {
    return std::numeric_limits<float>::infinity();
  }
  using Vector6d = Eigen::Matrix<double, kParameters, 1>;
  Eigen::Matrix<double, kParameters, kParameters> A =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Vector6d b = Vector6d::Zero();
  double squares = 0.0;
  const Eigen::Vector3f right = plane.normal.unitOrthogonal();
  const Eigen::Vector3f up = plane.normal.cross(right);
  for (const CellGrid::Found& f : found) {
    const Eigen::Vector3f d = (grid.point(f.place) - plane.mean) / radius_m;
    const auto x = static_cast<double>(right.dot(d));
    const auto y = static_cast<double>(up.dot(d));
    const auto z = static_cast<double>(plane.normal.dot(d));
    Vector6d row;
    row << 1.0, x, y, x * x, x * y, y * y;
    A.noalias() += row * row.transpose();
    b += z * row;
    squares += z * z;
  }
  const double left = squares - b.dot(A.ldlt().solve(b));
  return radius_m * static_cast<float>(std::sqrt(std::max(left, 0.0) /
                                                 static_cast<double>(found.size() - kParameters)));
}

// How a point was seen.
struct Ray {
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();  // unit
  float range_m = 0.0F;

  // How much of a scatter along the ray is left along a normal. Of what is grazed the rest has
  // other causes.
  float steepness(const Eigen::Vector3f& normal) const {
    constexpr float kGrazing = 0.1F;
    return std::max(std::abs(normal.dot(direction)), kGrazing);
  }
};

Ray ray_to(const PreparedCloud& cloud, std::size_t i) {
  const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
  const Eigen::Vector3f sight = cloud.points[i] - cloud.viewpoints[which];
  const float range_m = sight.norm();
  if (!(range_m > 0.0F)) return {};
  return {sight / range_m, range_m};
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
    std::vector<CellGrid::Found> found;
    for (std::size_t k = begin; k < end; ++k) {
      if ((k - begin) % kBlock == 0) context.check("preprocess");
      const bool bent = shape == SurfaceShape::kBent;
      const Ray ray = ray_to(cloud, sample[k]);
      const float radius =
          bent ? static_cast<float>(radius_m) : noise_radius_m(radius_m, ray.range_m);
      const PlaneFit plane = fit_plane(grid, cloud.points[sample[k]], radius, found);
      sigma[k] = bent ? scatter_about_quadric(grid, plane, found, radius)
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
  const CellGrid grid(cloud.points, radius_m / kCellsPerRadius);
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
    const Ray ray = ray_to(cloud, i);
    const float ratio = left * noise.at(ray.range_m) * ray.steepness(cloud.normals[i]) / half;
    weights[i] = 1.0F / (1.0F + ratio * ratio);
  }
  return weights;
}

void flatten_range_noise(PreparedCloud& cloud,
                         const RangeNoise& noise,
                         double radius_m,
                         const RunContext& context) {
  constexpr double kHarmless = 0.2;        // of the resolution: normals and descriptors bear it
  constexpr float kRadiusPerNoise = 5.0F;  // wide enough to hold the whole slab of scattered points
  constexpr double kMostWider = 3.0;       // times the radius
  constexpr float kStillPlane = 2.0F;      // times the noise: beyond, the surface is no plane
  constexpr float kNarrower = 0.7F;
  const auto harmless = static_cast<float>(kHarmless * cloud.resolution_m);
  if (noise.sigma_m.empty() || noise.sigma_m.back() <= harmless) return;

  const CellGrid grid(cloud.points, radius_m / kCellsPerRadius);
  PointCloud flat;
  flat.points = cloud.points;
  flat.normals = cloud.normals;
  flat.origin = cloud.origin;
  flat.viewpoints = cloud.viewpoints;
  flat.viewpoint_index = cloud.viewpoint_index;
  parallel_chunks(cloud.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<CellGrid::Found> found;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kBlock == 0) context.check("preprocess");
      const Ray ray = ray_to(cloud, i);
      const float sigma_m = noise.at(ray.range_m);
      if (sigma_m <= harmless) continue;
      const auto least = static_cast<float>(radius_m);
      float radius =
          std::clamp(kRadiusPerNoise * sigma_m, least, static_cast<float>(kMostWider * radius_m));
      for (; radius >= least; radius *= kNarrower) {
        const PlaneFit fit = fit_plane(grid, cloud.points[i], radius, found);
        if (!(fit.sigma_m <= kStillPlane * sigma_m * ray.steepness(fit.normal))) continue;
        flat.points[i] -= fit.normal * fit.normal.dot(cloud.points[i] - fit.mean);
        flat.normals[i] = fit.normal.dot(cloud.normals[i]) < 0.0F ? -fit.normal : fit.normal;
        break;
      }
    }
  });
  PointCloud thinned = thin(flat, cloud.resolution_m);
  cloud.points = std::move(thinned.points);
  cloud.normals = std::move(thinned.normals);
  cloud.viewpoint_index = std::move(thinned.viewpoint_index);
}

}  // namespace landmarkdb
