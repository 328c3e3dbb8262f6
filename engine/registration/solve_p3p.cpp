#include "engine/registration/solve_p3p.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Eigenvalues>

#include "engine/geometry/pose.hpp"

namespace landmarkdb {

namespace {

constexpr double kTiny = 1e-12;

// Real positive roots of c4 x^4 + ... + c0, by the eigenvalues of the companion matrix, polished by
// Newton.
std::vector<double> positive_roots(const std::array<double, 5>& c) {
  double size = 0.0;
  for (const double v : c) size = std::max(size, std::abs(v));
  if (!std::isfinite(size) || std::abs(c[4]) <= kTiny * size) return {};
  Eigen::Matrix4d companion = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 3; ++i) companion(i + 1, i) = 1.0;
  for (int i = 0; i < 4; ++i) companion(i, 3) = -c[static_cast<std::size_t>(i)] / c[4];
  const Eigen::EigenSolver<Eigen::Matrix4d> solver(companion, false);
  constexpr double kReal = 1e-3;  // a double root comes out as a pair with a small imaginary part
  std::vector<double> roots;
  for (int i = 0; i < 4; ++i) {
    const auto root = solver.eigenvalues()(i);
    if (std::abs(root.imag()) > kReal * std::max(1.0, std::abs(root.real()))) continue;
    double x = root.real();
    for (int round = 0; round < 3; ++round) {
      const double value = (((c[4] * x + c[3]) * x + c[2]) * x + c[1]) * x + c[0];
      const double slope = ((4.0 * c[4] * x + 3.0 * c[3]) * x + 2.0 * c[2]) * x + c[1];
      if (std::abs(slope) <= kTiny * size) break;
      x -= value / slope;
    }
    if (x > 0.0 && std::isfinite(x)) roots.push_back(x);
  }
  return roots;
}

}  // namespace

std::vector<Eigen::Isometry3d> solve_p3p(std::span<const Eigen::Vector3d, 3> bearings,
                                         std::span<const Eigen::Vector3d, 3> points) {
  // Haralick et al. 1994, section 3.1: a, b, c are the triangle's sides opposite point 1, 2, 3;
  // alpha, beta, gamma the angles under which they are seen. s2 = u s1, s3 = v s1.
  const double a2 = (points[1] - points[2]).squaredNorm();
  const double b2 = (points[0] - points[2]).squaredNorm();
  const double c2 = (points[0] - points[1]).squaredNorm();
  const Eigen::Vector3d across = (points[1] - points[0]).cross(points[2] - points[0]);
  if (!(across.squaredNorm() > kTiny * b2 * c2)) return {};
  const double ca = bearings[1].dot(bearings[2]);
  const double cb = bearings[0].dot(bearings[2]);
  const double cg = bearings[0].dot(bearings[1]);
  const double amc = (a2 - c2) / b2;
  const double apc = (a2 + c2) / b2;
  const double a_b = a2 / b2;
  const double c_b = c2 / b2;
  const std::array<double, 5> quartic = {
      (1.0 + amc) * (1.0 + amc) - 4.0 * a_b * cg * cg,
      4.0 * (-amc * (1.0 + amc) * cb + 2.0 * a_b * cg * cg * cb - (1.0 - apc) * ca * cg),
      2.0 * (amc * amc - 1.0 + 2.0 * amc * amc * cb * cb + 2.0 * (1.0 - c_b) * ca * ca -
             4.0 * apc * ca * cb * cg + 2.0 * (1.0 - a_b) * cg * cg),
      4.0 * (amc * (1.0 - amc) * cb - (1.0 - apc) * ca * cg + 2.0 * c_b * ca * ca * cb),
      (amc - 1.0) * (amc - 1.0) - 4.0 * c_b * ca * ca};
  std::vector<Eigen::Isometry3d> poses;
  for (const double v : positive_roots(quartic)) {
    const double below = 2.0 * (cg - v * ca);
    if (std::abs(below) <= kTiny) continue;
    const double u = ((amc - 1.0) * v * v - 2.0 * amc * cb * v + 1.0 + amc) / below;
    const double s1_squared = b2 / (1.0 + v * v - 2.0 * v * cb);
    if (!(u > 0.0) || !(s1_squared > 0.0) || !std::isfinite(s1_squared)) continue;
    const double s1 = std::sqrt(s1_squared);
    const std::array<Eigen::Vector3d, 3> seen = {
        s1 * bearings[0], u * s1 * bearings[1], v * s1 * bearings[2]};
    const std::optional<Similarity> fit = estimate_similarity(seen, points, false);
    if (!fit) continue;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = fit->R;
    T.translation() = fit->t;
    poses.push_back(T);
  }
  return poses;
}

}  // namespace landmarkdb
