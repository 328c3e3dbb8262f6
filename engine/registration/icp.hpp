#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

struct IcpOptions {
  // The robust scale shrinks from the first to the second, as a multiple of the target's cell: a
  // pair further apart than its scale counts for little (Geman and McClure 1987).
  double start_scale_cells = 1.5;
  double end_scale_cells = 0.4;
  int max_iterations = 25;
  // Cosine, more than 0: surfaces turned further than 60 deg apart are no pair.
  double min_normal_agreement = 0.5;
  double stop_translation_cells = 3e-3;  // 0.15 mm in a place described at 5 cm
  double stop_rotation_rad = 3e-5;       // as much 5 m away
};

struct IcpResult {
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  double rmse_m = 0.0;  // point-to-plane, of the paired points, weighted
  double paired = 0.0;  // share of the source points that found a partner
  // Information (inverse covariance up to the noise variance) of (translation, rotation about
  // `centre_target`), target frame: the sum of w J^T J with J = [n, (p - centre) x n].
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector3d centre_target = Eigen::Vector3d::Zero();
  double noise_m2 = 0.0;  // weighted variance of the residuals
  bool converged = false;
};

// Point-to-plane ICP (Chen and Medioni 1992) of source points with normals onto a surface, from the
// guess `T_target_source`. Metres. A freedom that the surface does not fix (a slide along a wall)
// is left as it is. Deterministic; thread-safe.
IcpResult refine_icp(const SurfaceGrid& target,
                     std::span<const Eigen::Vector3f> source,
                     std::span<const Eigen::Vector3f> source_normals,
                     const Eigen::Isometry3d& T_target_source,
                     const IcpOptions& options);

}  // namespace landmarkdb
