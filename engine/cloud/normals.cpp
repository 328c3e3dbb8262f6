#include "engine/cloud/normals.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/cloud/gathered_points.hpp"
#include "engine/cloud/orient_normals.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kFewestNeighbours = 5;  // the point itself is one of them
constexpr std::size_t kMostOfLine = 7;        // of which a far scanner's line has within the radius
constexpr std::size_t kStep = 64;             // cells between two looks at the stop token

struct PlaneFit {
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();
  double width = 0.0;      // second eigenvalue against the first: 1 for a disc, 0 for a line
  double thickness = 1.0;  // third against the second: 0 for a plane
};

// The least-squares plane; no normal where the points are on one line or in one place.
PlaneFit plane_of(const Eigen::Matrix3d& covariance) {
  constexpr double kCollinear = 1e-6;  // below, float rounding alone could make the plane
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d& values = solver.eigenvalues();  // ascending
  if (!(values[2] > 0.0) || !(values[1] > kCollinear * values[2])) return {};
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  if (!normal.allFinite()) return {};
  return {normal, values[1] / values[2], values[0] / values[1]};
}

PlaneFit fit_plane(const std::vector<Eigen::Vector3f>& points,
                   const Eigen::Vector3f& centre,
                   std::span<const Neighbour> neighbours) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Neighbour& neighbour : neighbours) {
    const Eigen::Vector3d d = (points[neighbour.index] - centre).cast<double>();
    mean += d;
    squares.noalias() += d * d.transpose();
  }
  const double n = static_cast<double>(neighbours.size());
  mean /= n;
  return plane_of(squares / n - mean * mean.transpose());
}

// Far from a scanner its lines lie further apart than the radius reaches: the few neighbours are of
// one line, and what noise they have would turn the plane about it. The radius is doubled there
// until another line of the same plane is met. What stays a line, a rail or a wire, keeps the plane
// of the first radius.
PlaneFit fit_wide_enough(const std::vector<Eigen::Vector3f>& points,
                         const Eigen::Vector3f& centre,
                         float radius,
                         const SpatialIndex& index,
                         std::vector<Neighbour>& neighbours) {
  constexpr double kLine = 0.1;  // half a disc, as at an edge, has 0.28
  constexpr double kFlat = 0.05;
  constexpr float kMostRadii = 4.0F;
  index.within_unordered(centre, radius, neighbours);
  const std::size_t around = neighbours.size();
  if (around < kFewestNeighbours) index.nearest(centre, kFewestNeighbours, neighbours);
  const PlaneFit first = fit_plane(points, centre, neighbours);
  if (around > kMostOfLine || (around >= kFewestNeighbours && first.width >= kLine)) return first;
  for (float reach = 2.0F; reach <= kMostRadii; reach *= 2.0F) {
    index.within_unordered(centre, reach * radius, neighbours);
    if (neighbours.size() < kFewestNeighbours) continue;
    const PlaneFit fit = fit_plane(points, centre, neighbours);
    if (fit.width >= kLine && fit.thickness <= kFlat) return fit;
  }
  return first;
}

// Sums in single precision tell no thinner bands from lines: these are looked at in double.
bool is_band(const PlaneFit& fit) {
  constexpr double kLeastWidth = 1e-3;
  return fit.width >= kLeastWidth;
}

// The planes about the points of one cell. Most have enough neighbours for one at once; the rest
// are searched for.
void fit_cell(PointCloud& cloud,
              float radius,
              const CellGrid& grid,
              const CellGrid::Run& cell,
              const SpatialIndex& index,
              GatheredPoints& around,
              std::vector<Neighbour>& neighbours) {
  const CellGrid::Ball ball = grid.ball_around(cell);
  around.gather(grid, ball.centre, radius + ball.radius_m);
  for (std::uint32_t place = cell.begin; place < cell.end; ++place) {
    const std::size_t i = grid.order()[place];
    const Moments moments = around.moments(cloud.points[i], radius);
    PlaneFit fit;
    if (moments.count > static_cast<float>(kMostOfLine)) {
      fit = plane_of(covariance_of(moments).cast<double>());
    }
    cloud.normals[i] =
        is_band(fit)
            ? fit.normal
            : fit_wide_enough(cloud.points, cloud.points[i], radius, index, neighbours).normal;
  }
}

void fit_planes(PointCloud& cloud,
                double radius_m,
                const SpatialIndex& index,
                const RunContext& context) {
  const auto radius = static_cast<float>(radius_m);
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::Zero());
  const CellGrid grid(cloud.points, radius_m);
  parallel_runs(grid.cells(), kStep, context.threads, [&](std::size_t begin, std::size_t end) {
    if (context.should_stop()) return;
    GatheredPoints around;
    std::vector<Neighbour> neighbours;
    for (std::size_t i = begin; i < end; ++i) {
      fit_cell(cloud, radius, grid, grid.cell(i), index, around, neighbours);
    }
  });
  context.check("normals");
}

void turn_to_viewpoints(PointCloud& cloud, const RunContext& context) {
  parallel_chunks(cloud.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
      const Eigen::Vector3f to_viewpoint = cloud.viewpoints[which] - cloud.points[i];
      Eigen::Vector3f& normal = cloud.normals[i];
      if (normal.isZero(0.0F)) {
        const float distance = to_viewpoint.norm();
        normal =
            distance > 0.0F ? Eigen::Vector3f(to_viewpoint / distance) : Eigen::Vector3f::UnitZ();
      } else if (normal.dot(to_viewpoint) < 0.0F) {
        normal = -normal;
      }
    }
  });
}

}  // namespace

bool estimate_normals(PointCloud& cloud,
                      double radius_m,
                      const SpatialIndex& index,
                      const RunContext& context) {
  if (!(radius_m > 0.0) || !std::isfinite(radius_m)) {
    throw Error(ErrorCode::kInvalidArgument,
                "normal radius is " + std::to_string(radius_m) + " m, want a positive length");
  }
  fit_planes(cloud, radius_m, index, context);
  if (!cloud.viewpoints.empty()) {
    turn_to_viewpoints(cloud, context);
    return true;
  }
  orient_consistently(cloud.points, cloud.normals, index, context);
  for (Eigen::Vector3f& normal : cloud.normals) {
    if (normal.isZero(0.0F)) normal = Eigen::Vector3f::UnitZ();
  }
  return false;
}

}  // namespace landmarkdb
