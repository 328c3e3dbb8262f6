#include "engine/features/range_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/base/parallel.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "engine/features/cell_grid.hpp"

namespace landmarkdb {
namespace {

constexpr double kCellsPerRadius = 2.0;  // as in describe_shot
constexpr std::size_t kBlock = 256;      // points between two looks at the stop request
constexpr std::size_t kFewestOfBin = 50;
constexpr std::size_t kLooked = 25'000;  // points the noise is taken from, of clouds twice as large
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

float range_of(const PreparedCloud& cloud, std::size_t i) {
  const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
  return (cloud.points[i] - cloud.viewpoints[which]).norm();
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

// Wide enough to hold several of the sheets that a depth camera's quantised disparity leaves of a
// far wall.
float noise_radius_m(double radius_m, float range_m) {
  constexpr float kOfRange = 0.05F;
  const auto least = static_cast<float>(radius_m);
  return std::clamp(kOfRange * range_m, least, static_cast<float>(kMostWider) * least);
}

}  // namespace

float RangeNoise::at(float range_m) const {
  if (sigma_m.empty()) return 0.0F;
  return sigma_m[std::min(bin_of(first_range_m, range_m), sigma_m.size() - 1)];
}

RangeNoise measure_range_noise(const PreparedCloud& cloud,
                               double radius_m,
                               const RunContext& context) {
  RangeNoise noise;
  noise.first_range_m = 10.0 * cloud.resolution_m;
  if (cloud.viewpoints.empty()) return noise;
  const CellGrid grid(cloud.points, radius_m / kCellsPerRadius);
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kLooked);
  std::vector<float> sigma((cloud.size() + step - 1) / step);
  parallel_chunks(sigma.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<CellGrid::Found> found;
    for (std::size_t k = begin; k < end; ++k) {
      if ((k - begin) % kBlock == 0) context.check("preprocess");
      const float radius = noise_radius_m(radius_m, range_of(cloud, k * step));
      sigma[k] = fit_plane(grid, cloud.points[k * step], radius, found).sigma_m;
    }
  });
  std::vector<std::vector<float>> bins;
  for (std::size_t k = 0; k < sigma.size(); ++k) {
    if (!std::isfinite(sigma[k])) continue;
    const std::size_t bin = bin_of(noise.first_range_m, range_of(cloud, k * step));
    if (bin >= bins.size()) bins.resize(bin + 1);
    bins[bin].push_back(sigma[k]);
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

std::vector<float> range_weights(const PreparedCloud& cloud, const RangeNoise& noise) {
  std::vector<float> weights(cloud.size(), 1.0F);
  if (noise.sigma_m.empty()) return weights;
  constexpr double kHalf = 0.3;  // of the resolution: noise at which a point counts for half
  const auto half = static_cast<float>(kHalf * cloud.resolution_m);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float ratio = noise.at(range_of(cloud, i)) / half;
    weights[i] = 1.0F / (1.0F + ratio * ratio);
  }
  return weights;
}

void flatten_range_noise(PreparedCloud& cloud,
                         const RangeNoise& noise,
                         double radius_m,
                         const RunContext& context) {
  constexpr double kHarmless = 0.2;        // of the resolution: normals and descriptors bear it
  constexpr float kRadiusPerNoise = 7.0F;  // wide enough to hold the whole slab of scattered points
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
      const float sigma_m = noise.at(range_of(cloud, i));
      if (sigma_m <= harmless) continue;
      const auto least = static_cast<float>(radius_m);
      float radius =
          std::clamp(kRadiusPerNoise * sigma_m, least, static_cast<float>(kMostWider * radius_m));
      for (; radius >= least; radius *= kNarrower) {
        const PlaneFit fit = fit_plane(grid, cloud.points[i], radius, found);
        if (!(fit.sigma_m <= kStillPlane * sigma_m)) continue;
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
