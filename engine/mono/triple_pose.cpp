#include "engine/mono/triple_pose.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "engine/mono/line_of_sight.hpp"
#include "engine/mono/weak_perspective.hpp"

namespace landmarkdb {
namespace {

// |e1 x e2| in squares of the longest side, and the cosine of the tilt, below which nothing is
// said.
constexpr double kCollinear = 1e-3;

using Rays = std::array<Eigen::Vector2d, 3>;

RigidPose pose_of(const ModelTriple& triple,
                  const Eigen::Matrix2d& A,
                  const Eigen::Vector2d& w,
                  double s,
                  const Eigen::Vector2d& center) {
  const Eigen::Vector3d a1 = s * (A(0, 0) * triple.u + A(0, 1) * triple.v) + w.x() * triple.n;
  const Eigen::Vector3d a2 = s * (A(1, 0) * triple.u + A(1, 1) * triple.v) + w.y() * triple.n;
  RigidPose pose;
  pose.R.row(0) = a1;
  pose.R.row(1) = a2;
  pose.R.row(2) = a1.cross(a2);
  pose.t = s * Eigen::Vector3d(center.x(), center.y(), 1.0) - pose.R * triple.centroid;
  return pose;
}

}  // namespace

bool complete_triple(const std::array<Eigen::Vector3d, 3>& points_m, ModelTriple& triple) {
  const Eigen::Vector3d e1 = points_m[1] - points_m[0], e2 = points_m[2] - points_m[0];
  const std::array<double, 3> lengths{e1.norm(), e2.norm(), (e2 - e1).norm()};
  const double longest = std::max({lengths[0], lengths[1], lengths[2]});
  const Eigen::Vector3d normal = e1.cross(e2);
  if (!(normal.norm() >= kCollinear * longest * longest) || !(longest > 0.0) ||
      !std::isfinite(longest)) {
    return false;
  }
  triple.lengths_m = lengths;
  triple.u = e1 / lengths[0];
  triple.n = normal.normalized();
  triple.v = triple.n.cross(triple.u);
  triple.centroid = (points_m[0] + points_m[1] + points_m[2]) / 3.0;
  const double ev = e2.dot(triple.v);
  triple.inverse = {1.0 / lengths[0], -e2.dot(triple.u) / (lengths[0] * ev), 1.0 / ev};
  const double area = normal.norm();
  triple.min_sin = std::min({area / (lengths[0] * lengths[1]),
                             area / (lengths[0] * lengths[2]),
                             area / (lengths[1] * lengths[2])});
  return true;
}

TriplePoses solve_triple(const ModelTriple& triple, const Rays& rays) {
  TriplePoses result;
  const Eigen::Vector2d m1 = rays[1] - rays[0], m2 = rays[2] - rays[0];
  const auto& [i00, i01, i11] = triple.inverse;
  Eigen::Matrix2d A;
  A.col(0) = m1 * i00;
  A.col(1) = m1 * i01 + m2 * i11;
  if (!A.allFinite()) return result;
  PlaneTilt tilt;
  result.status = PoseStatus::kCollinearImage;
  if (!solve_plane_tilt(A, tilt)) return result;
  result.depth_m = tilt.depth;
  result.cos_tilt = tilt.cos_tilt;
  result.from_front = tilt.mirrored;
  if (result.cos_tilt >= kCollinear) result.status = PoseStatus::kOk;
  const Eigen::Vector2d center = (rays[0] + rays[1] + rays[2]) / 3.0;
  result.poses[0] = pose_of(triple, A, tilt.w, tilt.depth, center);
  result.poses[1] = pose_of(triple, A, -tilt.w, tilt.depth, center);
  result.count = tilt.square_on ? 1 : 2;
  return result;
}

TriplePoses solve_triple_in_sight(const ModelTriple& triple, const Rays& rays) {
  const Eigen::Matrix3d Q = turn_into_sight(rays);
  TriplePoses result = solve_triple(triple, turned(Q, rays));
  for (int i = 0; i < result.count; ++i) {
    RigidPose& pose = result.poses[static_cast<std::size_t>(i)];
    pose.R = Q.transpose() * pose.R;
    pose.t = Q.transpose() * pose.t;
  }
  return result;
}

RigidPose correct_perspective(const ModelTriple& triple,
                              const std::array<Eigen::Vector3d, 3>& points_m,
                              const Rays& rays,
                              const RigidPose& pose,
                              int rounds) {
  const Eigen::Matrix3d Q = turn_into_sight(rays);
  const Rays straight = turned(Q, rays);
  RigidPose best{Q * pose.R, Q * pose.t};
  for (int round = 0; round < rounds; ++round) {
    const double s = (best * triple.centroid).z();
    Rays scaled = straight;
    for (std::size_t i = 0; i < scaled.size(); ++i) {
      scaled[i] *= 1.0 + best.R.row(2).dot(points_m[i] - triple.centroid) / s;
    }
    const TriplePoses next = solve_triple(triple, scaled);
    if (next.count == 0) break;
    // The branch nearest to the last one: the larger trace of R_last^T R.
    const double first = (best.R.cwiseProduct(next.poses[0].R)).sum();
    const double second = (best.R.cwiseProduct(next.poses[1].R)).sum();
    best = next.poses[second > first ? 1 : 0];
  }
  return {Q.transpose() * best.R, Q.transpose() * best.t};
}

}  // namespace landmarkdb
