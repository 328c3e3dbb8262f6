#include "engine/cloud/prepare_cloud.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/base/error.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spatial_index.hpp"
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

// Normals that came with the cloud are trusted unless they look away from known viewpoints.
bool normals_face_viewpoints(const PointCloud& cloud) {
  constexpr double kShare = 0.9;  // of the points; the rest may graze
  std::size_t facing = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::size_t which = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
    if (cloud.normals[i].dot(cloud.viewpoints[which] - cloud.points[i]) >= 0.0F) ++facing;
  }
  return static_cast<double>(facing) >= kShare * static_cast<double>(cloud.size());
}

}  // namespace

PreparedCloud prepare_cloud(const PointCloud& cloud,
                            const CloudCounts& counts,
                            const PrepareOptions& options,
                            const RunContext& context) {
  context.check("preprocess");
  PointCloud thinned = thin(cloud, options.voxel_m);
  check_spread(thinned.points);
  context.check("preprocess");
  bool oriented = true;  // normals that came with the cloud were turned by whoever made them
  const bool has_normals = thinned.normals.size() == thinned.size();
  if (!has_normals || (!thinned.viewpoints.empty() && !normals_face_viewpoints(thinned))) {
    const SpatialIndex index(thinned.points);
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
