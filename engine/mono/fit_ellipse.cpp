#include "engine/mono/fit_ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace landmarkdb {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Moves the points' mean to 0 and scales their rms radius to sqrt 2.
struct Frame {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double scale = 1.0;
};

std::optional<Frame> frame_of(std::span<const EdgePoint> points) {
  Frame frame;
  for (const EdgePoint& p : points) frame.mean += p.uv.cast<double>();
  frame.mean /= static_cast<double>(points.size());
  double sum = 0.0;
  for (const EdgePoint& p : points) sum += (p.uv.cast<double>() - frame.mean).squaredNorm();
  const double rms = std::sqrt(sum / static_cast<double>(points.size()));
  if (!(rms > 0.0) || !std::isfinite(rms)) return std::nullopt;
  frame.scale = std::numbers::sqrt2 / rms;
  return frame;
}

// The lower half of the sum of v v^T.
template <typename Vector, typename Matrix>
void add_square(const Vector& v, Matrix& sum) {
  for (Eigen::Index column = 0; column < v.size(); ++column) {
    for (Eigen::Index row = column; row < v.size(); ++row) sum(row, column) += v[row] * v[column];
  }
}

std::optional<Vector6d> fit_conic(std::span<const EdgePoint> points,
                                  const Frame& frame,
                                  const EdgeNoise& noise) {
  const double position = 1.0 / (noise.position_px * frame.scale);
  const double direction = 1.0 / noise.direction_rad;
  Matrix6d S = Matrix6d::Zero();
  Matrix5d T = Matrix5d::Zero();
  for (const EdgePoint& p : points) {
    const Eigen::Vector2d q = (p.uv.cast<double>() - frame.mean) * frame.scale;
    const double x = q.x(), y = q.y();
    const double tx = -p.normal.y(), ty = p.normal.x();
    Vector6d v, d;
    v << y * y, x * y, x * x, y, x, 1.0;
    d << 2.0 * y * ty, x * ty + y * tx, 2.0 * x * tx, ty, tx, 0.0;
    Vector5d gx, gy;
    gx << 0.0, y, 2.0 * x, 0.0, 1.0;
    gy << 2.0 * y, x, 0.0, 1.0, 0.0;
    v *= position;
    d *= direction;
    add_square(v, S);
    add_square(d, S);
    add_square(gx, T);
    add_square(gy, T);
  }
  S.triangularView<Eigen::StrictlyUpper>() = S.transpose();
  T.triangularView<Eigen::StrictlyUpper>() = T.transpose();
  // F enters S only: eliminate it.
  const Vector5d s = S.block<5, 1>(0, 5);
  const Matrix5d reduced = S.block<5, 5>(0, 0) - s * s.transpose() / S(5, 5);
  if (Eigen::LLT<Matrix5d>(T).info() != Eigen::Success) return std::nullopt;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix5d> solver(reduced, T);
  if (solver.info() != Eigen::Success) return std::nullopt;
  Vector6d th;
  th.head<5>() = solver.eigenvectors().col(0);
  th[5] = -s.dot(th.head<5>()) / S(5, 5);
  return th.allFinite() ? std::optional(th) : std::nullopt;
}

// nullopt for what is no ellipse, or one so flat that it is a line.
std::optional<ImageEllipse> ellipse_of(const Vector6d& th, const Frame& frame) {
  constexpr double kFlattest = 0.02;  // ratio of the axes
  Eigen::Matrix2d Q;
  Q << th[2], th[1] / 2.0, th[1] / 2.0, th[0];
  if (!(4.0 * th[0] * th[2] - th[1] * th[1] > 0.0)) return std::nullopt;
  const Eigen::Vector2d b(th[4], th[3]);
  const Eigen::Vector2d center = -0.5 * Q.inverse() * b;
  const double level = center.dot(Q * center) - th[5];  // x^T Q x = level about the centre
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes;
  axes.computeDirect(Q);
  const Eigen::Vector2d squares = level * axes.eigenvalues().cwiseInverse();
  if (!(squares.minCoeff() > 0.0) || !squares.allFinite()) return std::nullopt;
  const int major = squares[0] >= squares[1] ? 0 : 1;
  ImageEllipse ellipse;
  ellipse.center = center / frame.scale + frame.mean;
  ellipse.major_px = std::sqrt(squares[major]) / frame.scale;
  ellipse.minor_px = std::sqrt(squares[1 - major]) / frame.scale;
  ellipse.angle_rad = std::atan2(axes.eigenvectors()(1, major), axes.eigenvectors()(0, major));
  if (ellipse.minor_px < kFlattest * ellipse.major_px) return std::nullopt;
  return ellipse;
}

// Distance to first order, f / |grad f| with f = (p/a)^2 + (q/b)^2 - 1 in the ellipse's own axes,
// and the sine between the edge's tangent and the ellipse's.
class EllipseAt {
 public:
  using Slopes = Eigen::Matrix<double, 2, 5>;

  explicit EllipseAt(const Vector5d& e)
      : center_(e.head<2>()),
        per_a2_(2.0 / (e[2] * e[2])),
        per_b2_(2.0 / (e[3] * e[3])),
        per_a_(-2.0 / e[2]),
        per_b_(-2.0 / e[3]),
        cos_(std::cos(e[4])),
        sin_(std::sin(e[4])) {}

  // (distance, angle) of one point; with `slopes`, also how they change with (u, v, a, b, angle).
  Eigen::Vector2d residual(const EdgePoint& point, Slopes* slopes = nullptr) const {
    const Eigen::Vector2d w = point.uv.cast<double>() - center_;
    const double p = cos_ * w.x() + sin_ * w.y(), q = -sin_ * w.x() + cos_ * w.y();
    const double gp = per_a2_ * p, gq = per_b2_ * q;  // the gradient of f
    const double f = 0.5 * (gp * p + gq * q) - 1.0;
    const double per_slope = 1.0 / (std::sqrt(gp * gp + gq * gq) + 1e-12);
    const double nx = point.normal.x(), ny = point.normal.y();
    const double tp = -cos_ * ny + sin_ * nx, tq = sin_ * ny + cos_ * nx;  // the tangent
    const Eigen::Vector2d r(f * per_slope, (gp * tp + gq * tq) * per_slope);
    if (slopes == nullptr) return r;
    // f and its gradient change by df and (dgp, dgq), the tangent by dt.
    const auto column = [&](int i, double df, double dgp, double dgq, double dt) {
      const double dslope = (gp * dgp + gq * dgq) * per_slope;
      slopes->col(i) << (df - r[0] * dslope) * per_slope,
          (dgp * tp + dgq * tq + dt - r[1] * dslope) * per_slope;
    };
    column(0, -cos_ * gp + sin_ * gq, -cos_ * per_a2_, sin_ * per_b2_, 0.0);
    column(1, -sin_ * gp - cos_ * gq, -sin_ * per_a2_, -cos_ * per_b2_, 0.0);
    column(2, 0.5 * per_a_ * gp * p, per_a_ * gp, 0.0, 0.0);
    column(3, 0.5 * per_b_ * gq * q, 0.0, per_b_ * gq, 0.0);
    column(4, gp * q - gq * p, per_a2_ * q, -per_b2_ * p, gp * tq - gq * tp);
    return r;
  }

 private:
  Eigen::Vector2d center_;
  double per_a2_, per_b2_, per_a_, per_b_, cos_, sin_;
};

struct Cost {
  double sum = 0.0;
  double squares_px2 = 0.0;  // of the distances alone
};

struct Normal {
  Matrix5d H = Matrix5d::Zero();
  Vector5d g = Vector5d::Zero();
  Cost cost{};
};

Cost cost_of(const Vector5d& e, std::span<const EdgePoint> points, const EdgeNoise& noise) {
  const EllipseAt here(e);
  const Eigen::Vector2d weights(1.0 / noise.position_px, 1.0 / noise.direction_rad);
  Cost cost;
  for (const EdgePoint& point : points) {
    const Eigen::Vector2d r = here.residual(point);
    cost.sum += r.cwiseProduct(weights).squaredNorm();
    cost.squares_px2 += r[0] * r[0];
  }
  return cost;
}

Normal normal_equations(const Vector5d& e,
                        std::span<const EdgePoint> points,
                        const EdgeNoise& noise) {
  const EllipseAt here(e);
  const Eigen::Vector2d weights(1.0 / noise.position_px, 1.0 / noise.direction_rad);
  Normal sums;
  for (const EdgePoint& point : points) {
    EllipseAt::Slopes J;
    const Eigen::Vector2d r = here.residual(point, &J);
    const Eigen::Vector2d scaled = r.cwiseProduct(weights);
    J = weights.asDiagonal() * J;
    sums.H.noalias() += J.transpose() * J;
    sums.g.noalias() += J.transpose() * scaled;
    sums.cost.sum += scaled.squaredNorm();
    sums.cost.squares_px2 += r[0] * r[0];
  }
  return sums;
}

Vector5d parameters_of(const ImageEllipse& e) {
  return {e.center.x(), e.center.y(), e.major_px, e.minor_px, e.angle_rad};
}

ImageEllipse ellipse_from(const Vector5d& e) {
  ImageEllipse ellipse;
  ellipse.center = e.head<2>();
  ellipse.major_px = e[2];
  ellipse.minor_px = e[3];
  ellipse.angle_rad = e[4];
  if (ellipse.minor_px > ellipse.major_px) {
    std::swap(ellipse.minor_px, ellipse.major_px);
    ellipse.angle_rad += std::numbers::pi / 2.0;
  }
  ellipse.angle_rad = std::remainder(ellipse.angle_rad, std::numbers::pi);
  return ellipse;
}

}  // namespace

std::optional<EllipseFit> fit_ellipse(std::span<const EdgePoint> points, const EdgeNoise& noise) {
  constexpr std::size_t kFewest = 6;
  if (points.size() < kFewest) return std::nullopt;
  const std::optional<Frame> frame = frame_of(points);
  if (!frame) return std::nullopt;
  const std::optional<Vector6d> conic = fit_conic(points, *frame, noise);
  if (!conic) return std::nullopt;
  const std::optional<ImageEllipse> start = ellipse_of(*conic, *frame);
  if (!start) return std::nullopt;

  // One step of Gauss-Newton; a second changes the centre by less than 1 % of its error. A circle's
  // angle is free: a little damping keeps the system regular.
  Vector5d e = parameters_of(*start);
  const Normal sums = normal_equations(e, points, noise);
  Matrix5d H = sums.H;
  H.diagonal() *= 1.0 + 1e-6;
  H.diagonal().array() += 1e-9;
  const Eigen::LDLT<Matrix5d> solver(H);
  const Vector5d next = e - solver.solve(sums.g);
  Cost cost = sums.cost;
  if (next.allFinite() && next[2] > 0.0 && next[3] > 0.0) {
    const Cost trial = cost_of(next, points, noise);
    if (trial.sum < cost.sum) {
      e = next;
      cost = trial;
    }
  }
  EllipseFit fit;
  fit.ellipse = ellipse_from(e);
  fit.ellipse.rms_px = std::sqrt(cost.squares_px2 / static_cast<double>(points.size()));
  const Eigen::Matrix2d covariance =
      solver.solve(Eigen::Matrix<double, 5, 2>::Identity()).topRows<2>();
  fit.center_sigma_px =
      std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(covariance).eigenvalues()[1]);
  if (!std::isfinite(fit.center_sigma_px)) return std::nullopt;
  return fit;
}

Eigen::Matrix<double, 6, 1> conic_of(const ImageEllipse& ellipse, double unit_px) {
  const double c = std::cos(ellipse.angle_rad), s = std::sin(ellipse.angle_rad);
  Eigen::Matrix2d R;
  R << c, -s, s, c;
  const Eigen::Vector2d axes(ellipse.major_px / unit_px, ellipse.minor_px / unit_px);
  const Eigen::Matrix2d Q =
      R * axes.cwiseAbs2().cwiseInverse().asDiagonal() * R.transpose();  // x^T Q x = 1
  const Eigen::Vector2d center = ellipse.center / unit_px;
  const Eigen::Vector2d b = -2.0 * Q * center;
  Vector6d th;
  th << Q(1, 1), 2.0 * Q(0, 1), Q(0, 0), b.y(), b.x(), center.dot(Q * center) - 1.0;
  return th / b.norm();
}

double arc_of(const ImageEllipse& ellipse, std::span<const EdgePoint> points) {
  constexpr double kFull = 2.0 * std::numbers::pi;
  const double c = std::cos(ellipse.angle_rad), s = std::sin(ellipse.angle_rad);
  std::vector<double> angles;
  angles.reserve(points.size());
  for (const EdgePoint& p : points) {
    const Eigen::Vector2d w = p.uv.cast<double>() - ellipse.center;
    angles.push_back(std::atan2((-s * w.x() + c * w.y()) / ellipse.minor_px,
                                (c * w.x() + s * w.y()) / ellipse.major_px));
  }
  if (angles.empty()) return 0.0;
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + kFull - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return kFull - gap;
}

}  // namespace landmarkdb
