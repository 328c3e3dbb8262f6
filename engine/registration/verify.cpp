#include "engine/registration/verify.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace landmarkdb {

namespace {

// The 26 directions to a cube's faces, edges and corners, as bins of a normal.
std::size_t direction_of(const Eigen::Vector3f& n) {
  const auto part = [](float v) {
    return static_cast<std::size_t>(v > 0.38F ? 2 : (v < -0.38F ? 0 : 1));
  };
  return part(n.x()) + 3 * part(n.y()) +
         9 * part(n.z());  // 0.38 = sin(22.5 deg): half way between two
}

struct DirectionTally {
  double on_surface = 0.0;
  double all = 0.0;
};

// The mean over the directions that occur; a direction counts fully from 2 % of the points on.
double balanced_share(std::span<const DirectionTally> tallies, double points) {
  double sum = 0.0;
  double weights = 0.0;
  for (const DirectionTally& tally : tallies) {
    if (tally.all <= 0.0) continue;
    const double weight = std::min(1.0, tally.all / (0.02 * points));
    sum += weight * tally.on_surface / tally.all;
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : 0.0;
}

}  // namespace

void measure_overlap(const SurfaceGrid& target,
                     std::span<const Eigen::Vector3f> source,
                     std::span<const Eigen::Vector3f> source_normals,
                     const Eigen::Isometry3d& T_target_source,
                     const ScannedSpace* scanned,
                     const VerifyOptions& options,
                     Evidence& evidence) {
  const Eigen::Matrix3f R = T_target_source.linear().cast<float>();
  const Eigen::Vector3f t = T_target_source.translation().cast<float>();
  const auto tolerance = static_cast<float>(options.surface_tolerance_cells) * target.cell_m();
  const auto agreement = static_cast<float>(options.min_normal_agreement);
  std::array<DirectionTally, 27> tallies{};
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double on_surface = 0.0;
  double squared = 0.0;
  double refuted = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const Eigen::Vector3f n = R * source_normals[i];
    const Eigen::Vector3f p = R * source[i] + t;
    const Surfel* surfel = target.near(p);
    DirectionTally& tally = tallies[direction_of(n)];
    tally.all += 1.0;
    if (surfel == nullptr && scanned != nullptr && scanned->is_empty_at(p)) refuted += 1.0;
    if (surfel == nullptr || surfel->normal.dot(n) < agreement) continue;
    const float distance = surfel->normal.dot(p - surfel->point);
    if (std::abs(distance) > tolerance) continue;
    tally.on_surface += 1.0;
    on_surface += 1.0;
    squared += static_cast<double>(distance) * distance;
    scatter += (surfel->normal * surfel->normal.transpose()).cast<double>();
  }
  const auto points = static_cast<double>(source.size());
  if (points <= 0.0) return;
  evidence.overlap = on_surface / points;
  evidence.refuted = refuted / points;
  evidence.balanced = balanced_share(tallies, points);
  evidence.rmse_m = on_surface > 0.0 ? std::sqrt(squared / on_surface) : 0.0;
  if (on_surface > 0.0) evidence.strength = scatter.diagonal() / on_surface;
}

void measure_sight(std::span<const RangeImage> ranges,
                   const SightSurface& entry,
                   const Eigen::Isometry3d& T_sensor_entry,
                   double cell_m,
                   const VerifyOptions& options,
                   Evidence& evidence) {
  const SightTolerance tolerance{static_cast<float>(options.sight_tolerance_cells * cell_m),
                                 static_cast<float>(options.sight_tolerance_range),
                                 static_cast<float>(options.contradiction_share)};
  SightCounts counts;
  for (const RangeImage& image : ranges) {
    counts += image.compare(entry, T_sensor_entry, static_cast<float>(cell_m), tolerance);
  }
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  // A view of a few directions proves little: it is drawn towards a half, as if these had been seen
  // too.
  constexpr std::size_t kPriorDirections = 50;
  evidence.explained =
      share(2 * counts.agree + kPriorDirections, 2 * (counts.predicted() + kPriorDirections));
  evidence.crossed = share(counts.crossed, counts.predicted());
  evidence.coverage = share(counts.predicted(), counts.measured);
  evidence.contradicted = options.hidden_contradicts
                              ? share(counts.solid, counts.predicted())
                              : share(counts.solid_crossed, counts.agree + counts.crossed);
}

double observability(const IcpResult& icp, double source_extent_m, std::size_t source_points) {
  if (source_points == 0 || !(source_extent_m > 0.0)) return 0.0;
  Eigen::Matrix<double, 6, 1> s;
  s << 1.0, 1.0, 1.0, Eigen::Vector3d::Constant(1.0 / source_extent_m);
  const Eigen::Matrix<double, 6, 6> scaled = s.asDiagonal() * icp.information * s.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(scaled,
                                                                          Eigen::EigenvaluesOnly);
  const double smallest = solver.eigenvalues()(0) / static_cast<double>(source_points);
  return std::clamp(3.0 * smallest, 0.0, 1.0);
}

}  // namespace landmarkdb
