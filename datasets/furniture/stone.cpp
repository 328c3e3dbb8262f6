#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {

void add_round_column(Workshop shop, const Eigen::Isometry3d& T, double radius, double height) {
  begin_object(shop.mesh, "column");
  const double r = radius;
  const double belly = shop.random.uniform(0.0, 0.08);
  std::vector<Eigen::Vector2d> profile = {
      {1.5 * r, 0.0}, {1.5 * r, 0.12}, {1.3 * r, 0.16}, {1.35 * r, 0.24}, {1.05 * r, 0.3}};
  constexpr int kDrums = 6;
  for (int i = 0; i <= kDrums; ++i) {
    const double t = static_cast<double>(i) / kDrums;
    profile.emplace_back(r * (1.0 - 0.12 * t + belly * std::sin(std::numbers::pi * t)),
                         0.3 + (height - 0.85) * t);
  }
  profile.insert(profile.end(),
                 {{1.05 * r, height - 0.5},
                  {1.5 * r, height - 0.2},
                  {1.6 * r, height - 0.12},
                  {1.6 * r, height}});
  add_revolution(shop.mesh, T, profile, 28);
  add_box(shop.mesh, T * at(0, 0, height - 0.1), {3.4 * r, 3.4 * r, 0.1});
}

void add_square_column(Workshop shop, const Eigen::Isometry3d& T, double width, double height) {
  begin_object(shop.mesh, "column");
  add_box(shop.mesh, T, {width, width, height});
  add_box(shop.mesh, T, {width + 0.06, width + 0.06, 0.15});
  if (shop.random.uniform() < 0.4) {
    add_box(shop.mesh,
            T * at(0, -0.5 * width - 0.02, shop.random.uniform(1.2, 1.5)),
            {0.7 * width, 0.04, 0.5});
  }
}

void add_statue(Workshop shop, const Eigen::Isometry3d& T, double height) {
  begin_object(shop.mesh, "statue");
  const double h = height;
  const auto blob = [&](double x, double y, double z, Eigen::Vector3d radii, double roughness) {
    add_blob(shop.mesh,
             T * at(x * h, y * h, z * h, shop.random.uniform(-0.3, 0.3)),
             {.radii = radii * h,
              .squareness_z = shop.random.uniform(0.7, 1.1),
              .squareness_xy = shop.random.uniform(0.7, 1.1),
              .roughness = roughness,
              .wavelength = 0.4,
              .seed = shop.random.next(),
              .detail = 14});
  };
  add_tapered_box(shop.mesh, T, {0.42 * h, 0.42 * h, 0.22 * h}, 0.85);
  const double lean = shop.random.uniform(-0.05, 0.05);
  if (shop.random.uniform() < 0.5) {  // standing
    blob(0.0, 0.0, 0.38, {0.13, 0.11, 0.2}, 0.12);
    blob(lean, 0.0, 0.62, {0.15, 0.1, 0.18}, 0.1);
    blob(1.4 * lean, -0.01, 0.88, {0.065, 0.075, 0.09}, 0.1);
    blob(-0.16, -0.03, 0.6, {0.045, 0.05, 0.16}, 0.15);
    blob(0.16, -shop.random.uniform(0.0, 0.12), 0.62, {0.045, 0.06, 0.14}, 0.15);
  } else {  // seated, with crossed legs
    blob(0.0, -0.05, 0.3, {0.27, 0.2, 0.1}, 0.12);
    blob(lean, 0.04, 0.52, {0.16, 0.11, 0.2}, 0.1);
    blob(1.5 * lean, 0.03, 0.8, {0.08, 0.085, 0.1}, 0.1);
    blob(1.5 * lean, 0.03, 0.92, {0.04, 0.04, 0.06}, 0.1);
    blob(-0.2, -0.04, 0.46, {0.05, 0.08, 0.15}, 0.15);
    blob(0.2, -0.04, 0.46, {0.05, 0.08, 0.15}, 0.15);
  }
}

void add_altar(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "altar");
  const double width = shop.random.uniform(1.8, 3.0);
  const int steps = 2 + static_cast<int>(shop.random.below(3));
  for (int i = 0; i < steps; ++i) {
    const double grow = 0.35 * (steps - i);
    add_box(shop.mesh, T * at(0, 0, 0.17 * i), {width + 2 * grow, 1.2 + 2 * grow, 0.17});
  }
  const double z = 0.17 * steps;
  add_box(shop.mesh, T * at(0, 0, z), {width, 1.0, 0.65});
  add_box(shop.mesh, T * at(0, 0, z + 0.65), {width + 0.2, 1.2, 0.12});
  const int offerings = 3 + static_cast<int>(shop.random.below(4));
  for (int i = 0; i < offerings; ++i) {
    const double x = width * ((i + 0.5) / offerings - 0.5);
    const double r = shop.random.uniform(0.06, 0.14);
    const Eigen::Vector2d bowl[] = {{0.5 * r, 0.0}, {0.3 * r, r}, {r, 1.8 * r}, {0.8 * r, 2.4 * r}};
    add_revolution(shop.mesh, T * at(x, shop.random.uniform(-0.3, 0.1), z + 0.77), bowl, 14);
  }
  add_statue(shop, T * at(0.0, 0.15, z + 0.77), shop.random.uniform(1.0, 1.5));
}

void add_urn(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "urn");
  const double h = shop.random.uniform(0.5, 1.2);
  const double fat = shop.random.uniform(0.22, 0.36);
  std::vector<Eigen::Vector2d> profile;
  constexpr int kRings = 12;
  for (int i = 0; i <= kRings; ++i) {
    const double t = static_cast<double>(i) / kRings;
    const double r = 0.35 + 0.65 * std::sin(std::numbers::pi * std::pow(t, 0.8) * 0.93);
    profile.emplace_back(h * fat * r, h * t);
  }
  profile.emplace_back(h * fat * 0.65, h * 1.03);
  add_revolution(shop.mesh, T, profile, 24);
}

void add_rubble(Workshop shop, const Eigen::Isometry3d& T, int blocks) {
  begin_object(shop.mesh, "rubble");
  for (int i = 0; i < blocks; ++i) {
    const double size = shop.random.uniform(0.12, 0.5);
    Eigen::Isometry3d T_block = T * at(0.5 * shop.random.normal(),
                                       0.5 * shop.random.normal(),
                                       0.3 * size,
                                       shop.random.uniform(0.0, 6.3));
    T_block.rotate(Eigen::AngleAxisd(
        0.3 * shop.random.normal(),
        Eigen::Vector3d(shop.random.normal(), shop.random.normal(), 0.1).normalized()));
    add_blob(shop.mesh,
             T_block,
             {.radii = {size * shop.random.uniform(0.6, 1.3), size, size * 0.6},
              .squareness_z = 0.35,
              .squareness_xy = 0.35,
              .roughness = 0.12,
              .wavelength = 0.5,
              .seed = shop.random.next(),
              .detail = 9});
  }
}

void add_stele(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "stele");
  const double width = shop.random.uniform(0.5, 0.9);
  const double height = shop.random.uniform(1.2, 2.0);
  add_box(shop.mesh, T, {width + 0.3, 0.5, 0.25});
  std::vector<Eigen::Vector2d> outline = {
      {-0.5 * width, 0.0}, {0.5 * width, 0.0}, {0.5 * width, height}};
  for (int i = 1; i < 8; ++i) {  // a rounded top
    const double angle = std::numbers::pi * i / 8.0;
    outline.emplace_back(0.5 * width * std::cos(angle), height + 0.5 * width * std::sin(angle));
  }
  outline.emplace_back(-0.5 * width, height);
  Eigen::Isometry3d T_slab = T * at(0, 0.1, 0.25);
  T_slab.rotate(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  add_prism(shop.mesh, T_slab, outline, 0.2);
}

}  // namespace landmarkdb::datasets
