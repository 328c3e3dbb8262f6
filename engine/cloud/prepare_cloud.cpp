#include "engine/cloud/prepare_cloud.hpp"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include "engine/base/error.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spatial_index.hpp"
#include "engine/cloud/strays.hpp"
#include "engine/cloud/voxel_grid.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kFewestPoints = 4;

// Throws when the points span no plane: no normal, and no pose, comes out of them.
void check_spread(const std::vector<Eigen::Vector3f>& points) {
  constexpr double kCollinear = 1e-8;  // second variance against the first: 0.1 mm on a metre
  if (points.size() < kFewestPoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "the cloud has " + std::to_string(points.size()) +
                    " points at the working resolution, want at least " +
                    std::to_string(kFewestPoints));
  }
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) mean += p.cast<double>();
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d d = p.cast<double>() - mean;
    covariance += d * d.transpose();
  }
  const Eigen::Vector3d variances =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues();
  if (!(variances[1] > kCollinear * variances[2])) {
    throw Error(ErrorCode::kInvalidArgument,
                "all points of the cloud lie on one line, want a surface");
  }
}

// Whether normals that came with a cloud look towards the viewpoints it has.
bool face_viewpoints(const PointCloud& cloud) {
  constexpr double kShare = 0.9;  // of the points; the rest may graze
  std::size_t facing = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
    if (cloud.normals[i].dot(cloud.viewpoints[which] - cloud.points[i]) >= 0.0F) ++facing;
  }
  return static_cast<double>(facing) >= kShare * static_cast<double>(cloud.size());
}

// Whether normals that came with a cloud were turned to one side: among parallel neighbours few are
// opposite. Clouds with oriented normals have 0 to 7 % of these, plane fits left as they fell 30 to
// 50 %.
bool share_a_side(const PointCloud& cloud, const SpatialIndex& index) {
  constexpr std::size_t kLooked = 20'000;
  constexpr std::size_t kNeighbours = 7;  // the point and six around it
  constexpr float kParallel = 0.7F;
  constexpr double kMostOpposite = 0.2;
  const std::size_t step = cloud.size() / kLooked + 1;
  std::size_t parallel = 0;
  std::size_t opposite = 0;
  std::vector<Neighbour> neighbours;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    index.nearest(cloud.points[i], kNeighbours, neighbours);
    for (const Neighbour& neighbour : neighbours) {
      const float cosine = cloud.normals[i].dot(cloud.normals[neighbour.index]);
      if (neighbour.index == i || std::abs(cosine) < kParallel) continue;
      ++parallel;
      if (cosine < 0.0F) ++opposite;
    }
  }
  return static_cast<double>(opposite) <= kMostOpposite * static_cast<double>(parallel);
}

// Whether the cloud came with normals that can be used as they are.
bool own_normals_hold(const PointCloud& cloud, const SpatialIndex& index) {
  if (cloud.normals.size() != cloud.size()) return false;
  return cloud.viewpoints.empty() ? share_a_side(cloud, index) : face_viewpoints(cloud);
}

}  // namespace

PreparedCloud prepare_cloud(const PointCloud& cloud,
                            const CloudCounts& counts,
                            const PrepareOptions& options,
                            const RunContext& context) {
  context.check("preprocess");
  PointCloud thinned = thin(cloud, options.voxel_m, context);
  if (options.without_strays) drop_strays(thinned, options.normal_radius_m, context);
  check_spread(thinned.points);
  context.check("preprocess");
  const SpatialIndex index(thinned.points, context);
  bool oriented = true;
  if (!own_normals_hold(thinned, index)) {
    oriented = estimate_normals(thinned, options.normal_radius_m, index, context);
  }
  PreparedCloud prepared;
  prepared.points = std::move(thinned.points);
  prepared.normals = std::move(thinned.normals);
  prepared.origin = thinned.origin;
  prepared.viewpoints = std::move(thinned.viewpoints);
  prepared.viewpoint_index = std::move(thinned.viewpoint_index);
  prepared.resolution_m = options.voxel_m;
  prepared.normals_from_viewpoint = oriented;
  prepared.counts = counts;
  return prepared;
}

}  // namespace landmarkdb
