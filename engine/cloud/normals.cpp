#include "engine/cloud/normals.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/cloud/orient_normals.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kFewestNeighbours = 5;  // the point itself is one of them
constexpr std::size_t kStep = 1024;           // points between two looks at the stop token

// The normal of the least-squares plane; zero where the points are on one line or in one place.
Eigen::Vector3f plane_normal(const std::vector<Eigen::Vector3f>& points,
                             const Eigen::Vector3f& centre,
                             std::span<const Neighbour> neighbours) {
  // Second eigenvalue against the first: below, float rounding alone could make the plane.
  constexpr double kCollinear = 1e-6;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const Neighbour& neighbour : neighbours) {
    const Eigen::Vector3d d = (points[neighbour.index] - centre).cast<double>();
    mean += d;
    squares.noalias() += d * d.transpose();
  }
  const double n = static_cast<double>(neighbours.size());
  mean /= n;
  const Eigen::Matrix3d covariance = squares / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d& values = solver.eigenvalues();  // ascending
  if (!(values[2] > 0.0) || !(values[1] > kCollinear * values[2])) return Eigen::Vector3f::Zero();
  const Eigen::Vector3f normal = solver.eigenvectors().col(0).cast<float>();
  return normal.allFinite() ? normal : Eigen::Vector3f::Zero();
}

void fit_planes(PointCloud& cloud,
                double radius_m,
                const SpatialIndex& index,
                const RunContext& context) {
  const auto radius = static_cast<float>(radius_m);
  cloud.normals.assign(cloud.size(), Eigen::Vector3f::Zero());
  parallel_chunks(cloud.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<Neighbour> neighbours;
    for (std::size_t i = begin; i < end; ++i) {
      if ((i - begin) % kStep == 0 && context.should_stop()) return;
      index.within_unordered(cloud.points[i], radius, neighbours);
      if (neighbours.size() < kFewestNeighbours) {
        index.nearest(cloud.points[i], kFewestNeighbours, neighbours);
      }
      cloud.normals[i] = plane_normal(cloud.points, cloud.points[i], neighbours);
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
