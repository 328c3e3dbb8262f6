#include "engine/mono/pose_equations.hpp"

#include <cmath>

namespace landmarkdb {
namespace {

// A ray and its derivatives by (w, t).
struct RaySlope {
  double x, y;
  std::array<double, 6> dx, dy;
};

// A plain point: rho = R P, X = rho + t.
bool slope_of_point(const Eigen::Vector3d& rho, const Eigen::Vector3d& X, RaySlope& s) {
  if (!(X.z() > 0.0)) return false;
  const double iz = 1.0 / X.z();
  const double x = X.x() * iz, y = X.y() * iz;
  const double r1 = rho.x(), r2 = rho.y(), r3 = rho.z();
  s.x = x;
  s.y = y;
  s.dx = {-x * iz * r2, iz * r3 + x * iz * r1, -iz * r2, iz, 0.0, -x * iz};
  s.dy = {-iz * r3 - y * iz * r2, y * iz * r1, iz * r1, 0.0, iz, -y * iz};
  return true;
}

// The centre of the ellipse that a circle is seen as. The cone of its tangent planes l has
// (l . C)^2 = r^2 (|l|^2 - (l . N)^2), so its dual conic is C C^T - r^2 (I - N N^T), and the centre
// is that matrix' last column. An ellipse has E E^T, E its PosePoint::longer, taken off as well.
bool slope_of_area(const Eigen::Vector3d& rho,
                   const Eigen::Vector3d& C,
                   const Eigen::Vector3d& N,
                   const Eigen::Vector3d& E,
                   double radius_m,
                   RaySlope& s) {
  const double rr = radius_m * radius_m;
  const double below = C.z() * C.z() - rr * (1.0 - N.z() * N.z()) - E.z() * E.z();
  if (!(C.z() > 0.0) || !(below > 0.0)) return false;
  s.x = (C.x() * C.z() + rr * N.x() * N.z() - E.x() * E.z()) / below;
  s.y = (C.y() * C.z() + rr * N.y() * N.z() - E.y() * E.z()) / below;
  // Columns: w1 w2 w3 t1 t2 t3. A turn w moves rho by w x rho, N by w x N and E by w x E.
  const std::array<double, 6> c1{0.0, rho.z(), -rho.y(), 1.0, 0.0, 0.0};
  const std::array<double, 6> c2{-rho.z(), 0.0, rho.x(), 0.0, 1.0, 0.0};
  const std::array<double, 6> c3{rho.y(), -rho.x(), 0.0, 0.0, 0.0, 1.0};
  const std::array<double, 6> n1{0.0, N.z(), -N.y(), 0.0, 0.0, 0.0};
  const std::array<double, 6> n2{-N.z(), 0.0, N.x(), 0.0, 0.0, 0.0};
  const std::array<double, 6> n3{N.y(), -N.x(), 0.0, 0.0, 0.0, 0.0};
  const std::array<double, 6> e1{0.0, E.z(), -E.y(), 0.0, 0.0, 0.0};
  const std::array<double, 6> e2{-E.z(), 0.0, E.x(), 0.0, 0.0, 0.0};
  const std::array<double, 6> e3{E.y(), -E.x(), 0.0, 0.0, 0.0, 0.0};
  for (std::size_t k = 0; k < 6; ++k) {
    const double db = 2.0 * (C.z() * c3[k] + rr * N.z() * n3[k] - E.z() * e3[k]);
    const double dx = c1[k] * C.z() + C.x() * c3[k] + rr * (n1[k] * N.z() + N.x() * n3[k]) -
                      (e1[k] * E.z() + E.x() * e3[k]);
    const double dy = c2[k] * C.z() + C.y() * c3[k] + rr * (n2[k] * N.z() + N.y() * n3[k]) -
                      (e2[k] * E.z() + E.y() * e3[k]);
    s.dx[k] = (dx - s.x * db) / below;
    s.dy[k] = (dy - s.y * db) / below;
  }
  return true;
}

// Turns a ray and its derivatives into pixels.
bool to_pixels(const Camera& camera, bool bent, RaySlope& s) {
  if (!bent) {
    s.x = camera.fx * s.x + camera.cx;
    s.y = camera.fy * s.y + camera.cy;
    for (std::size_t k = 0; k < 6; ++k) {
      s.dx[k] *= camera.fx;
      s.dy[k] *= camera.fy;
    }
    return true;
  }
  const Eigen::Vector2d ray(s.x, s.y);
  if (!inside_lens_model(camera, ray)) return false;
  const LensPoint lens = distort_with_slope(camera, ray);
  s.x = lens.uv.x();
  s.y = lens.uv.y();
  for (std::size_t k = 0; k < 6; ++k) {
    const double dx = s.dx[k], dy = s.dy[k];
    s.dx[k] = lens.duv_dray(0, 0) * dx + lens.duv_dray(0, 1) * dy;
    s.dy[k] = lens.duv_dray(1, 0) * dx + lens.duv_dray(1, 1) * dy;
  }
  return true;
}

bool is_bent(const Camera& camera) {
  for (const double k : camera.dist) {
    if (k != 0.0) return true;
  }
  return false;
}

void add_row(const std::array<double, 6>& J, double residual, double weight, PoseEquations& eq) {
  std::size_t at = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    const double wj = weight * J[i];
    for (std::size_t k = 0; k <= i; ++k) eq.H[at++] += wj * J[k];
    eq.g[i] += wj * residual;
  }
}

// Huber's weight of a residual of this many sigmas, whose cost is added.
double huber_weight(double squared, double huber, PoseEquations& eq) {
  if (squared <= huber * huber) {
    eq.cost += squared;
    return 1.0;
  }
  const double norm = std::sqrt(squared);
  eq.cost += 2.0 * huber * norm - huber * huber;
  return huber / norm;
}

}  // namespace

Eigen::Matrix<double, 6, 6> PoseEquations::matrix() const {
  Eigen::Matrix<double, 6, 6> full;
  std::size_t at = 0;
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k <= i; ++k, ++at) full(i, k) = full(k, i) = H[at];
  }
  return full;
}

bool add_points(std::span<const PosePoint> points,
                const Camera& camera,
                const RigidPose& pose,
                double huber,
                PoseEquations& equations) {
  const bool bent = is_bent(camera);
  RaySlope s;
  for (const PosePoint& point : points) {
    const Eigen::Vector3d rho = pose.R * point.xyz;
    const bool seen = point.radius_m > 0.0 ? slope_of_area(rho,
                                                           rho + pose.t,
                                                           pose.R * point.normal,
                                                           pose.R * point.longer,
                                                           point.radius_m,
                                                           s)
                                           : slope_of_point(rho, rho + pose.t, s);
    if (!seen || !to_pixels(camera, bent, s)) return false;
    const double ru = s.x - point.uv.x(), rv = s.y - point.uv.y();
    const double scale = 1.0 / (point.sigma_px * point.sigma_px);
    const double weight = scale * huber_weight(scale * (ru * ru + rv * rv), huber, equations);
    add_row(s.dx, ru, weight, equations);
    add_row(s.dy, rv, weight, equations);
  }
  return true;
}

bool add_edges(std::span<const PoseEdge> edges,
               const Camera& camera,
               const RigidPose& pose,
               double huber,
               PoseEquations& equations) {
  const bool bent = is_bent(camera);
  RaySlope s;
  for (const PoseEdge& edge : edges) {
    const Eigen::Vector3d rho = pose.R * edge.xyz;
    if (!slope_of_point(rho, rho + pose.t, s) || !to_pixels(camera, bent, s)) return false;
    const double residual =
        edge.normal.x() * (s.x - edge.uv.x()) + edge.normal.y() * (s.y - edge.uv.y());
    const double scale = 1.0 / (edge.sigma_px * edge.sigma_px);
    const double weight = scale * huber_weight(scale * residual * residual, huber, equations);
    for (std::size_t k = 0; k < 6; ++k) {
      s.dx[k] = edge.normal.x() * s.dx[k] + edge.normal.y() * s.dy[k];
    }
    add_row(s.dx, residual, weight, equations);
  }
  return true;
}

SeenRay seen_ray(const PosePoint& point, const RigidPose& pose) {
  SeenRay seen;
  const Eigen::Vector3d C = pose * point.xyz;
  const double rr = point.radius_m * point.radius_m;
  const Eigen::Vector3d N =
      rr > 0.0 ? Eigen::Vector3d(pose.R * point.normal) : Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d E =
      rr > 0.0 ? Eigen::Vector3d(pose.R * point.longer) : Eigen::Vector3d::Zero();
  const double below = C.z() * C.z() - rr * (1.0 - N.z() * N.z()) - E.z() * E.z();
  seen.ok = C.z() > 0.0 && below > 0.0;
  if (seen.ok) {
    seen.ray = (C.head<2>() * C.z() + rr * N.z() * N.head<2>() - E.z() * E.head<2>()) / below;
  }
  return seen;
}

}  // namespace landmarkdb
