#include "engine/mono/stretched_rival.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

constexpr double kTolerance = 0.005;  // of the diameter: how well a body's points follow its model
constexpr double kSameRatio = 0.005, kOtherRatio = 0.3;  // sigmas of the logarithm of a ratio
constexpr double kHuber = 2.0;
constexpr double kEdgesTogether = 8.0;  // neighbouring samples of an edge are off together
constexpr int kSteps = 4;

using Unknowns = Eigen::Matrix<double, 8, 1>;  // turn, shift, two stretches
using Information = Eigen::Matrix<double, 8, 8>;

// Two ways to stretch that keep the mean of the logarithms.
Eigen::Matrix<double, 3, 2> ways_to_stretch() {
  Eigen::Matrix<double, 3, 2> B;
  B << 1.0, 1.0, -1.0, 1.0, 0.0, -2.0;
  B.col(0) /= std::numbers::sqrt2;
  B.col(1) /= std::sqrt(6.0);
  return B;
}

class StretchSolver {
 public:
  StretchSolver(const SearchModel& model, const Camera& camera, const RigidPose& pose)
      : center_(model.center),
        axes_(stretch_axes(model)),
        ways_(ways_to_stretch()),
        camera_(camera),
        pose_(pose) {
    const double focal = 0.5 * (std::abs(camera.fx) + std::abs(camera.fy));
    tolerance_px_ = kTolerance * focal * model.model().diameter_m / (pose * center_).z();
  }

  bool step(std::span<const PosePoint> points, std::span<const PoseEdge> edges) {
    H_.setZero();
    g_.setZero();
    for (const PosePoint& point : points) {
      PosePoint moved = point;
      moved.xyz = stretched(point.xyz);
      const SeenRay seen = seen_ray(moved, pose_);
      Eigen::Matrix<double, 2, 8> J;
      Eigen::Vector2d uv;
      if (!seen.ok || !slopes(point.xyz, uv, J)) return false;
      add(J.row(0), J.row(1), distort(camera_, seen.ray) - point.uv, point.sigma_px);
    }
    for (const PoseEdge& edge : edges) {
      Eigen::Matrix<double, 2, 8> J;
      Eigen::Vector2d uv;
      if (!slopes(edge.xyz, uv, J)) return false;
      const double sigma2 = edge.sigma_px * edge.sigma_px + tolerance_px_ * tolerance_px_;
      const double r = edge.normal.dot(uv - edge.uv);
      const double weight = huber(std::abs(r), sigma2) / (sigma2 * kEdgesTogether);
      const Eigen::Matrix<double, 1, 8> row = edge.normal.transpose() * J;
      H_.noalias() += weight * row.transpose() * row;
      g_.noalias() += weight * r * row.transpose();
    }
    Information damped = H_;
    damped.diagonal() *= 1.0 + 1e-6;
    damped(6, 6) += 1.0 / (kOtherRatio * kOtherRatio);
    damped(7, 7) += 1.0 / (kOtherRatio * kOtherRatio);
    Unknowns g = g_;
    g.tail<2>() += stretch_ / (kOtherRatio * kOtherRatio);
    const Unknowns x = -damped.ldlt().solve(g);
    if (!x.allFinite()) return false;
    pose_.R = rotation_from_vector(x.head<3>()) * pose_.R;
    pose_.t += x.segment<3>(3);
    stretch_ += x.tail<2>();
    return stretch_.cwiseAbs().maxCoeff() < kMostStretch;
  }

  // Of the ratios as they are seen, with what noise and tolerance make of them, under both.
  double log10_odds() const {
    const Eigen::Matrix<double, 6, 6> pose = H_.topLeftCorner<6, 6>();
    const Eigen::Matrix<double, 6, 2> both = H_.topRightCorner<6, 2>();
    Eigen::Matrix2d seen =
        H_.bottomRightCorner<2, 2>() - both.transpose() * pose.ldlt().solve(both);
    seen = 0.5 * (seen + seen.transpose().eval());
    seen.diagonal().array() += kBlur;
    const Eigen::Matrix2d spread = seen.inverse();
    // The prior that held the steps is taken off again: the estimate as the image alone has it.
    const Eigen::Matrix2d prior = Eigen::Matrix2d::Identity() / (kOtherRatio * kOtherRatio);
    const Eigen::Vector2d free = stretch_ + spread * prior * stretch_;
    const double odds =
        (log_density(free, spread, kSameRatio) - log_density(free, spread, kOtherRatio)) /
        std::numbers::ln10;
    return std::isfinite(odds) ? odds : 0.0;
  }

  Eigen::Vector3d log_ratios() const { return ways_ * stretch_; }

 private:
  static constexpr double kMostStretch = 1.5;
  static constexpr double kBlur = 1e-3;  // information that is always there: keeps it invertible

  static double log_density(const Eigen::Vector2d& x, Eigen::Matrix2d spread, double sigma) {
    spread.diagonal().array() += sigma * sigma;
    return -0.5 * (std::log(spread.determinant()) + x.dot(spread.inverse() * x));
  }

  static double huber(double r, double sigma2) {
    const double bound = kHuber * std::sqrt(sigma2);
    return r <= bound ? 1.0 : bound / r;
  }

  Eigen::Vector3d ratios() const { return (ways_ * stretch_).array().exp(); }

  Eigen::Vector3d stretched(const Eigen::Vector3d& P) const {
    return center_ + axes_ * ratios().cwiseProduct(axes_.transpose() * (P - center_));
  }

  bool slopes(const Eigen::Vector3d& P, Eigen::Vector2d& uv, Eigen::Matrix<double, 2, 8>& J) const {
    const Eigen::Vector3d along = ratios().cwiseProduct(axes_.transpose() * (P - center_));
    const Eigen::Vector3d rho = pose_.R * (center_ + axes_ * along), X = rho + pose_.t;
    if (!(X.z() > 0.0)) return false;
    const Eigen::Vector2d ray = X.head<2>() / X.z();
    if (!inside_lens_model(camera_, ray)) return false;
    const LensPoint lens = distort_with_slope(camera_, ray);
    uv = lens.uv;
    Eigen::Matrix<double, 2, 3> D;
    D << 1.0 / X.z(), 0.0, -ray.x() / X.z(), 0.0, 1.0 / X.z(), -ray.y() / X.z();
    D = (lens.duv_dray * D).eval();
    Eigen::Matrix<double, 3, 8> dX;
    dX.leftCols<3>() << 0.0, rho.z(), -rho.y(), -rho.z(), 0.0, rho.x(), rho.y(), -rho.x(), 0.0;
    dX.middleCols<3>(3).setIdentity();
    for (Eigen::Index k = 0; k < 2; ++k)
      dX.col(6 + k) = pose_.R * (axes_ * ways_.col(k).cwiseProduct(along));
    J = D * dX;
    return true;
  }

  void add(const Eigen::Matrix<double, 1, 8>& u,
           const Eigen::Matrix<double, 1, 8>& v,
           const Eigen::Vector2d& r,
           double sigma_px) {
    const double sigma2 = sigma_px * sigma_px + tolerance_px_ * tolerance_px_;
    const double weight = huber(r.norm(), sigma2) / sigma2;
    H_.noalias() += weight * (u.transpose() * u + v.transpose() * v);
    g_.noalias() += weight * (r.x() * u.transpose() + r.y() * v.transpose());
  }

  Eigen::Vector3d center_;
  Eigen::Matrix3d axes_;
  Eigen::Matrix<double, 3, 2> ways_;
  const Camera& camera_;
  RigidPose pose_;
  double tolerance_px_ = 0.0;
  Eigen::Vector2d stretch_ = Eigen::Vector2d::Zero();
  Information H_ = Information::Zero();
  Unknowns g_ = Unknowns::Zero();
};

Eigen::Matrix3d principal_axes(const SearchModel& model) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const PosePoint& point : model.points) {
    const Eigen::Vector3d w = point.xyz - model.center;
    spread += w * w.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors();
}

}  // namespace

Eigen::Matrix3d stretch_axes(const SearchModel& model) {
  constexpr double kParallel = 0.999, kAcross = 0.05;  // cosines
  const MonoModel& m = model.model();
  std::vector<Eigen::Vector3d> edges;
  for (const auto& [a, b] : m.edges) edges.push_back(m.points[b].xyz - m.points[a].xyz);
  // The direction of most length among those across `other` (zero: among all).
  const auto longest = [&](const Eigen::Vector3d& other) {
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double most = 0.0;
    for (const Eigen::Vector3d& e : edges) {
      if (!(e.norm() > 0.0)) continue;
      const Eigen::Vector3d d = e.normalized();
      if (std::abs(d.dot(other)) > kAcross) continue;
      double length = 0.0;
      for (const Eigen::Vector3d& f : edges)
        length += std::abs(f.dot(d)) > kParallel * f.norm() ? f.norm() : 0.0;
      if (length > most) {
        most = length;
        best = d;
      }
    }
    return best;
  };
  const Eigen::Vector3d first = longest(Eigen::Vector3d::Zero());
  const Eigen::Vector3d second = longest(first);
  if (!(first.norm() > 0.0) || !(second.norm() > 0.0)) return principal_axes(model);
  Eigen::Matrix3d axes;
  axes.col(0) = first;
  axes.col(2) = first.cross(second).normalized();
  axes.col(1) = axes.col(2).cross(first);
  return axes;
}

Stretch stretched_rival(const SearchModel& model,
                        const Camera& camera,
                        const RigidPose& pose,
                        std::span<const PosePoint> points,
                        std::span<const PoseEdge> edges) {
  if (points.empty() || !((pose * model.center).z() > 0.0)) return {};
  StretchSolver solver(model, camera, pose);
  for (int i = 0; i < kSteps; ++i) {
    if (!solver.step(points, edges)) return {};
  }
  return {solver.log_ratios(), solver.log10_odds()};
}

}  // namespace landmarkdb
