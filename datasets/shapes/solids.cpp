#include <array>
#include <cmath>
#include <numbers>

#include "datasets/shapes/shapes.hpp"

namespace landmarkdb::datasets {

Eigen::Isometry3d at(double x, double y, double z, double yaw_rad) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = Eigen::Vector3d(x, y, z);
  return T;
}

void begin_object(TriangleMesh& mesh, const std::string& name, Material material) {
  mesh.objects.push_back({name, material});
}

void add_triangle(TriangleMesh& mesh,
                  const Eigen::Vector3d& a,
                  const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c) {
  constexpr double kNoArea_m2 = 1e-12;
  if ((b - a).cross(c - a).norm() < kNoArea_m2) return;
  if (mesh.objects.empty()) begin_object(mesh, "thing");
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3d& p : {a, b, c}) mesh.vertices.emplace_back(p.cast<float>());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.object.push_back(static_cast<std::uint32_t>(mesh.objects.size() - 1));
}

void add_quad(TriangleMesh& mesh,
              const Eigen::Vector3d& a,
              const Eigen::Vector3d& b,
              const Eigen::Vector3d& c,
              const Eigen::Vector3d& d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

void add_box(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Eigen::Vector3d& size) {
  add_tapered_box(mesh, T, size, 1.0);
}

void add_tapered_box(TriangleMesh& mesh,
                     const Eigen::Isometry3d& T,
                     const Eigen::Vector3d& size,
                     double top_share) {
  const Eigen::Vector2d foot = 0.5 * size.head<2>();
  const Eigen::Vector2d top = top_share * foot;
  const auto corner = [&](int i, bool up) -> Eigen::Vector3d {
    const Eigen::Vector2d half = up ? top : foot;
    const double x = i == 0 || i == 3 ? -half.x() : half.x();
    const double y = i < 2 ? -half.y() : half.y();
    return T * Eigen::Vector3d(x, y, up ? size.z() : 0.0);
  };
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    add_quad(mesh, corner(i, false), corner(j, false), corner(j, true), corner(i, true));
  }
  add_quad(mesh, corner(0, true), corner(1, true), corner(2, true), corner(3, true));
  add_quad(mesh, corner(3, false), corner(2, false), corner(1, false), corner(0, false));
}

void add_prism(TriangleMesh& mesh,
               const Eigen::Isometry3d& T,
               std::span<const Eigen::Vector2d> outline,
               double height) {
  const auto corner = [&](std::size_t i, double z) -> Eigen::Vector3d {
    return T * Eigen::Vector3d(outline[i].x(), outline[i].y(), z);
  };
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t j = (i + 1) % outline.size();
    add_quad(mesh, corner(i, 0.0), corner(j, 0.0), corner(j, height), corner(i, height));
  }
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
    add_triangle(mesh, corner(0, height), corner(i, height), corner(i + 1, height));
    add_triangle(mesh, corner(0, 0.0), corner(i + 1, 0.0), corner(i, 0.0));
  }
}

void add_revolution(TriangleMesh& mesh,
                    const Eigen::Isometry3d& T,
                    std::span<const Eigen::Vector2d> profile,
                    int segments) {
  const auto point = [&](const Eigen::Vector2d& rz, int k) -> Eigen::Vector3d {
    const double angle = 2.0 * std::numbers::pi * (k % segments) / segments;
    return T * Eigen::Vector3d(rz.x() * std::cos(angle), rz.x() * std::sin(angle), rz.y());
  };
  const Eigen::Vector3d bottom = T * Eigen::Vector3d(0.0, 0.0, profile.front().y());
  const Eigen::Vector3d top = T * Eigen::Vector3d(0.0, 0.0, profile.back().y());
  for (int k = 0; k < segments; ++k) {
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
      add_quad(mesh,
               point(profile[i], k),
               point(profile[i], k + 1),
               point(profile[i + 1], k + 1),
               point(profile[i + 1], k));
    }
    add_triangle(mesh, bottom, point(profile.front(), k + 1), point(profile.front(), k));
    add_triangle(mesh, top, point(profile.back(), k), point(profile.back(), k + 1));
  }
}

void add_cylinder(TriangleMesh& mesh, const Eigen::Isometry3d& T, double radius, double height) {
  const std::array<Eigen::Vector2d, 2> profile = {Eigen::Vector2d(radius, 0.0),
                                                  Eigen::Vector2d(radius, height)};
  constexpr double kThick_m = 0.15;
  add_revolution(mesh, T, profile, radius > kThick_m ? 28 : 12);
}

void add_rod(TriangleMesh& mesh,
             const Eigen::Isometry3d& T,
             const Eigen::Vector3d& from,
             const Eigen::Vector3d& to,
             double radius) {
  Eigen::Isometry3d T_rod = Eigen::Isometry3d::Identity();
  T_rod.linear() =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), to - from).toRotationMatrix();
  T_rod.translation() = from;
  const std::array<Eigen::Vector2d, 2> profile = {Eigen::Vector2d(radius, 0.0),
                                                  Eigen::Vector2d(radius, (to - from).norm())};
  constexpr int kSides = 8;
  add_revolution(mesh, T * T_rod, profile, kSides);
}

void add_blob(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Blob& blob) {
  const auto power = [](double base, double exponent) {
    return std::copysign(std::pow(std::abs(base), exponent), base);
  };
  const int rings = blob.detail;
  const int sectors = 2 * blob.detail;
  const auto point = [&](int ring, int sector) -> Eigen::Vector3d {
    const double latitude = std::numbers::pi * (static_cast<double>(ring) / rings - 0.5);
    const double longitude = 2.0 * std::numbers::pi * (sector % sectors) / sectors;
    const double c =
        ring == 0 || ring == rings ? 0.0 : power(std::cos(latitude), blob.squareness_z);
    const Eigen::Vector3d unit(c * power(std::cos(longitude), blob.squareness_xy),
                               c * power(std::sin(longitude), blob.squareness_xy),
                               power(std::sin(latitude), blob.squareness_z));
    const double swell = 1.0 + blob.roughness * smooth_noise(unit / blob.wavelength, blob.seed);
    return T * Eigen::Vector3d(swell * unit.cwiseProduct(blob.radii));
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < sectors; ++sector) {
      add_quad(mesh,
               point(ring, sector),
               point(ring, sector + 1),
               point(ring + 1, sector + 1),
               point(ring + 1, sector));
    }
  }
}

}  // namespace landmarkdb::datasets
