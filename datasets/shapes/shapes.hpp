#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/triangle_mesh.hpp"

// Solids and surfaces that places are put together from. `T` carries the shape's own frame to the
// scene; metres; all faces look outwards (walls and sheets: the way their comment says).
namespace landmarkdb::datasets {

// The frame at a point of the floor, turned about z.
Eigen::Isometry3d at(double x, double y, double z = 0.0, double yaw_rad = 0.0);

// All triangles added from now on belong to a new object of this name.
void begin_object(TriangleMesh& mesh,
                  const std::string& name,
                  Material material = Material::kOpaque);

void add_triangle(TriangleMesh& mesh,
                  const Eigen::Vector3d& a,
                  const Eigen::Vector3d& b,
                  const Eigen::Vector3d& c);

// Corners counter-clockwise, seen from the free side.
void add_quad(TriangleMesh& mesh,
              const Eigen::Vector3d& a,
              const Eigen::Vector3d& b,
              const Eigen::Vector3d& c,
              const Eigen::Vector3d& d);

// x and y centred on the origin, z from 0 to size.z.
void add_box(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Eigen::Vector3d& size);

// A box whose top is `top_share` as wide and deep as its foot.
void add_tapered_box(TriangleMesh& mesh,
                     const Eigen::Isometry3d& T,
                     const Eigen::Vector3d& size,
                     double top_share);

// `outline` convex, counter-clockwise in x y; from z = 0 to `height`.
void add_prism(TriangleMesh& mesh,
               const Eigen::Isometry3d& T,
               std::span<const Eigen::Vector2d> outline,
               double height);

// `profile`: (radius, z) from the lowest point upwards, turned about z; the ends are closed.
void add_revolution(TriangleMesh& mesh,
                    const Eigen::Isometry3d& T,
                    std::span<const Eigen::Vector2d> profile,
                    int segments);

void add_cylinder(TriangleMesh& mesh, const Eigen::Isometry3d& T, double radius, double height);

// A round bar between two points of the frame of T.
void add_rod(TriangleMesh& mesh,
             const Eigen::Isometry3d& T,
             const Eigen::Vector3d& from,
             const Eigen::Vector3d& to,
             double radius);

// A superquadric around the origin, displaced along its radius by smooth noise.
struct Blob {
  Eigen::Vector3d radii = {0.2, 0.2, 0.2};
  double squareness_z = 1.0;  // exponents: 1 round, 0.2 boxy, 2 pinched
  double squareness_xy = 1.0;
  double roughness = 0.0;   // share of the radius
  double wavelength = 0.6;  // of the noise, in radii
  std::uint64_t seed = 1;
  int detail = 12;  // rings
};
void add_blob(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Blob& blob);

// A hole in a wall: from x0 to x1 along it, z0 to z1 up.
struct Opening {
  double x0 = 0.0, x1 = 1.0, z0 = 0.0, z1 = 2.0;
  double depth_m = 0.1;                   // of the pane behind the wall's face
  bool through = false;                   // no pane; the wall must have a thickness
  Material material = Material::kOpaque;  // of the pane
};

// A wall along x, z up, its face at y = 0 looking towards -y. With a thickness there is a second
// face at y = thickness_m looking the other way. Openings must not overlap.
struct Wall {
  double length_m = 1.0, height_m = 1.0;
  double thickness_m = 0.0;
  std::vector<Opening> openings;
};
void add_wall(TriangleMesh& mesh, const Eigen::Isometry3d& T, const Wall& wall);

// A surface over [0, size.x] x [0, size.y], height by `height(x, y)`, looking towards +z.
void add_sheet(TriangleMesh& mesh,
               const Eigen::Isometry3d& T,
               const Eigen::Vector2d& size,
               double step_m,
               const std::function<double(double, double)>& height);

// Smooth noise in [-1, 1] with features of size 1 (value noise on the integer lattice).
double smooth_noise(const Eigen::Vector3d& p, std::uint64_t seed);

}  // namespace landmarkdb::datasets
