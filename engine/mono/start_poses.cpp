#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/mono/line_of_sight.hpp"
#include "engine/mono/point_pose.hpp"
#include "engine/mono/weak_perspective.hpp"

namespace landmarkdb {
namespace {

constexpr int kRounds = 4;       // of perspective correction: more change nothing that counts
constexpr double kLine = 1e-6;   // second eigenvalue of the scatter against the first
constexpr double kPlane = 1e-4;  // third against first: 1 % of thickness

struct Scatter {
  Eigen::Vector3d center;
  Eigen::Matrix3d axes;  // columns, by ascending eigenvalue
  Eigen::Vector3d values;
  Eigen::Matrix3d inverse;  // of the scatter, where it is not planar
};

// C = sum of (m (1 + e) - mean) (P - c)^T, and that mean.
struct Correlation {
  Eigen::Matrix<double, 2, 3> C = Eigen::Matrix<double, 2, 3>::Zero();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
};

Correlation correlate(std::span<const Eigen::Vector3d> xyz,
                      std::span<const Eigen::Vector2d> rays,
                      const Eigen::Matrix3d& Q,
                      const Eigen::Vector3d& center,
                      const Eigen::Vector3d& depth_slope) {
  Correlation result;
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    const Eigen::Vector3d from_center = xyz[i] - center;
    const Eigen::Vector2d m = turned(Q, rays[i]) * (1.0 + depth_slope.dot(from_center));
    result.mean += m;
    result.C +=
        m * from_center.transpose();  // sum of P - c is zero: the mean need not be taken off
  }
  result.mean /= static_cast<double>(xyz.size());
  return result;
}

RigidPose placed(const Eigen::Vector3d& a1,
                 const Eigen::Vector3d& a2,
                 double s,
                 const Eigen::Vector2d& mean,
                 const Eigen::Vector3d& center) {
  RigidPose pose;
  pose.R.row(0) = a1;
  pose.R.row(1) = a2;
  pose.R.row(2) = a1.cross(a2);
  pose.t = s * mean.homogeneous() - pose.R * center;
  return pose;
}

// Two by two: the inverse square root is closed.
bool solve_solid(const Scatter& scatter, const Correlation& seen, RigidPose& pose, double& s) {
  const Eigen::Matrix<double, 2, 3> L = seen.C * scatter.inverse;
  const Eigen::Matrix2d M = L * L.transpose();
  const double root = std::sqrt(std::max(0.0, M.determinant()));
  const double trace = std::sqrt(M.trace() + 2.0 * root);  // of M^(1/2)
  if (!(root > 0.0) || !std::isfinite(trace)) return false;
  Eigen::Matrix2d G = M;
  G.diagonal().array() += root;
  G /= trace;
  s = 2.0 / trace;
  const Eigen::Matrix<double, 2, 3> rows = G.inverse() * L;
  pose = placed(rows.row(0), rows.row(1), s, seen.mean, scatter.center);
  return true;
}

// Both branches of a plane; `last`: take the nearest of the two to it instead.
bool solve_plane(const Scatter& scatter,
                 const Correlation& seen,
                 const RigidPose* last,
                 std::array<RigidPose, 2>& poses,
                 int& count,
                 double& s) {
  const Eigen::Vector3d u = scatter.axes.col(2), v = scatter.axes.col(1), n = u.cross(v);
  Eigen::Matrix2d A;
  A.col(0) = seen.C * u / scatter.values(2);
  A.col(1) = seen.C * v / scatter.values(1);
  PlaneTilt tilt;
  if (!solve_plane_tilt(A, tilt)) return false;
  s = tilt.depth;
  const auto branch = [&](const Eigen::Vector2d& w) {
    return placed(s * (A(0, 0) * u + A(0, 1) * v) + w.x() * n,
                  s * (A(1, 0) * u + A(1, 1) * v) + w.y() * n,
                  s,
                  seen.mean,
                  scatter.center);
  };
  poses[0] = branch(tilt.w);
  poses[1] = branch(-tilt.w);
  count = tilt.square_on ? 1 : 2;
  if (last != nullptr) {
    const double first = last->R.cwiseProduct(poses[0].R).sum();
    if (last->R.cwiseProduct(poses[1].R).sum() > first) poses[0] = poses[1];
  }
  return true;
}

}  // namespace

StartPoses start_poses(std::span<const Eigen::Vector3d> xyz,
                       std::span<const Eigen::Vector2d> rays,
                       bool as_plane) {
  StartPoses result;
  result.status = PoseStatus::kTooFewPoints;
  if (xyz.size() < 4 || rays.size() != xyz.size()) return result;
  result.status = PoseStatus::kNotFinite;
  Scatter scatter;
  scatter.center.setZero();
  Eigen::Vector3d sight = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    scatter.center += xyz[i];
    sight += rays[i].homogeneous().normalized();
  }
  scatter.center /= static_cast<double>(xyz.size());
  Eigen::Matrix3d S = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : xyz) {
    S += (p - scatter.center) * (p - scatter.center).transpose();
  }
  if (!S.allFinite() || !sight.allFinite()) return result;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen;
  eigen.computeDirect(S);
  scatter.values = eigen.eigenvalues();
  scatter.axes = eigen.eigenvectors();
  result.status = PoseStatus::kCollinearModel;
  if (!(scatter.values(1) > kLine * scatter.values(2))) return result;
  result.planar = as_plane || !(scatter.values(0) > kPlane * scatter.values(2));
  if (!result.planar) scatter.inverse = S.inverse();
  const Eigen::Matrix3d Q = turn_to_axis(sight.normalized());
  result.status = PoseStatus::kCollinearImage;
  double s = 0.0;
  const Correlation plain = correlate(xyz, rays, Q, scatter.center, Eigen::Vector3d::Zero());
  if (result.planar) {
    if (!solve_plane(scatter, plain, nullptr, result.poses, result.count, s)) return result;
  } else {
    if (!solve_solid(scatter, plain, result.poses[0], s)) return result;
    result.count = 1;
  }
  const double plain_s = s;
  for (int b = 0; b < result.count; ++b) {
    RigidPose& pose = result.poses[static_cast<std::size_t>(b)];
    s = plain_s;
    for (int round = 0; round < kRounds; ++round) {
      const Eigen::Vector3d slope = pose.R.row(2).transpose() / s;
      const Correlation seen = correlate(xyz, rays, Q, scatter.center, slope);
      std::array<RigidPose, 2> next;
      int ignored = 0;
      const bool ok = result.planar ? solve_plane(scatter, seen, &pose, next, ignored, s)
                                    : solve_solid(scatter, seen, next[0], s);
      if (!ok) break;
      pose = next[0];
    }
    pose = {Q.transpose() * pose.R, Q.transpose() * pose.t};
  }
  result.status = PoseStatus::kOk;
  return result;
}

}  // namespace landmarkdb
