#include <algorithm>
#include <cmath>
#include <numbers>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {
namespace {

// A box on the wall: its back at y = 0, its middle at x, its foot at z.
void add_on_wall(TriangleMesh& mesh,
                 const Eigen::Isometry3d& T,
                 double x,
                 double z,
                 const Eigen::Vector3d& size) {
  add_box(mesh, T * at(x, -0.5 * size.y(), z), size);
}

}  // namespace

void add_picture(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "picture");
  const double w = shop.random.uniform(0.4, 1.6);
  const double h = shop.random.uniform(0.4, 1.2);
  const double frame = shop.random.uniform(0.03, 0.07);
  add_on_wall(shop.mesh, T, 0.0, 0.0, {w, 0.02, h});
  for (const double side : {-0.5, 0.5}) {
    add_on_wall(shop.mesh, T, side * (w - frame), 0.0, {frame, 0.05, h});
  }
  add_on_wall(shop.mesh, T, 0.0, 0.0, {w, 0.05, frame});
  add_on_wall(shop.mesh, T, 0.0, h - frame, {w, 0.05, frame});
}

void add_radiator(Workshop shop, const Eigen::Isometry3d& T, double width) {
  begin_object(shop.mesh, "radiator");
  const double height = shop.random.uniform(0.45, 0.65);
  const int ribs = std::max(3, static_cast<int>(width / 0.12));
  for (int i = 0; i < ribs; ++i) {
    add_on_wall(
        shop.mesh, T, width * ((i + 0.5) / ribs - 0.5), 0.12, {0.6 * width / ribs, 0.12, height});
  }
  add_rod(shop.mesh, T, {-0.5 * width, -0.06, 0.2}, {0.5 * width, -0.06, 0.2}, 0.02);
  add_rod(shop.mesh, T, {0.5 * width, -0.06, 0.0}, {0.5 * width, -0.06, 0.3}, 0.015);
}

void add_vent(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "air vent");
  const double w = shop.random.uniform(0.5, 1.1);
  const double h = shop.random.uniform(0.35, 0.6);
  for (const double side : {-0.5, 0.5}) {
    add_on_wall(shop.mesh, T, side * w, 0.0, {0.05, 0.1, h});
  }
  add_on_wall(shop.mesh, T, 0.0, -0.05, {w + 0.05, 0.1, 0.05});
  add_on_wall(shop.mesh, T, 0.0, h, {w + 0.05, 0.1, 0.05});
  const int slats = std::max(3, static_cast<int>(h / 0.08));
  for (int i = 0; i < slats; ++i) {
    Eigen::Isometry3d T_slat = T * at(0.0, -0.045, h * (i + 0.3) / slats);
    T_slat.rotate(Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitX()));
    add_box(shop.mesh, T_slat, {w, 0.07, 0.01});
  }
}

void add_extinguisher(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "fire extinguisher");
  const Eigen::Vector2d profile[] = {
      {0.08, 0.0}, {0.08, 0.42}, {0.03, 0.5}, {0.03, 0.56}, {0.05, 0.58}};
  add_revolution(shop.mesh, T * at(0.0, -0.12, 0.5), profile, 16);
  add_on_wall(shop.mesh, T, 0.0, 0.62, {0.1, 0.06, 0.06});
  add_on_wall(shop.mesh, T, 0.0, 1.4, {0.2, 0.02, 0.2});
}

void add_wall_box(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "wall box");
  const double w = shop.random.uniform(0.3, 1.0);
  const double h = shop.random.uniform(0.3, 0.9);
  const double d = shop.random.uniform(0.08, 0.25);
  add_on_wall(shop.mesh, T, 0.0, 0.0, {w, d, h});
  const int doors = 1 + static_cast<int>(shop.random.below(4));
  for (int i = 0; i < doors; ++i) {
    add_on_wall(
        shop.mesh, T, w * ((i + 0.5) / doors - 0.5), 0.04, {0.85 * w / doors, d + 0.02, h - 0.08});
  }
}

void add_sign(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "sign");
  add_box(shop.mesh, T * at(0.0, -0.22), {0.03, 0.4, shop.random.uniform(0.15, 0.3)});
}

void add_door_frame(Workshop shop, const Eigen::Isometry3d& T, double width, double height) {
  begin_object(shop.mesh, "door frame");
  constexpr double kFrame_m = 0.08;
  for (const double x : {-0.5 * kFrame_m, width + 0.5 * kFrame_m}) {
    add_on_wall(shop.mesh, T, x, 0.0, {kFrame_m, 0.03, height + kFrame_m});
  }
  add_on_wall(shop.mesh, T, 0.5 * width, height, {width, 0.03, kFrame_m});
}

void add_ceiling_lamp(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "ceiling lamp");
  const double length = shop.random.uniform(0.6, 1.5);
  add_box(shop.mesh, T * at(0, 0, -0.09), {length, 0.25, 0.09});
}

void add_pendant_lamp(Workshop shop, const Eigen::Isometry3d& T, double drop) {
  begin_object(shop.mesh, "pendant lamp");
  add_rod(shop.mesh, T, {0, 0, 0}, {0, 0, -drop}, 0.012);
  const double r = shop.random.uniform(0.15, 0.4);
  const Eigen::Vector2d shade[] = {
      {r, -drop - 0.25}, {0.95 * r, -drop - 0.15}, {0.5 * r, -drop}, {0.08, -drop + 0.05}};
  add_revolution(shop.mesh, T, shade, 22);
}

void add_pipe_run(Workshop shop, const Eigen::Isometry3d& T, double length) {
  begin_object(shop.mesh, "pipes");
  const int pipes = 1 + static_cast<int>(shop.random.below(4));
  double y = 0.0;
  for (int i = 0; i < pipes; ++i) {
    const double r = shop.random.uniform(0.02, 0.09);
    y += r + 0.04;
    const double z = -0.12 - r;
    const double end = length * shop.random.uniform(0.6, 1.0);
    add_rod(shop.mesh, T, {0.0, y, z}, {end, y, z}, r);
    if (end < 0.95 * length) add_rod(shop.mesh, T, {end, y, z}, {end, y, 0.0}, r);
    for (double x = 0.8; x < end; x += 2.4) {
      add_box(shop.mesh, T * at(x, y, z - r - 0.01), {0.04, 2 * r + 0.03, -z + r + 0.01});
    }
    y += r;
  }
}

void add_duct(Workshop shop, const Eigen::Isometry3d& T, double length) {
  begin_object(shop.mesh, "duct");
  const double w = shop.random.uniform(0.4, 0.8);
  const double h = shop.random.uniform(0.25, 0.4);
  add_box(shop.mesh, T * at(0.5 * length, 0.0, -h - 0.1), {length, w, h});
  for (double x = 1.0; x < length - 0.3; x += 1.5) {
    add_box(shop.mesh, T * at(x, 0.0, -h - 0.13), {0.05, w + 0.06, h + 0.13});
  }
  for (double x = 1.7; x < length - 0.5; x += shop.random.uniform(2.0, 4.0)) {
    const Eigen::Vector2d outlet[] = {{0.18, -h - 0.22}, {0.12, -h - 0.1}};
    add_revolution(shop.mesh, T * at(x, 0.0), outlet, 16);
  }
}

}  // namespace landmarkdb::datasets
