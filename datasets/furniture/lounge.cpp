#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {

void add_sofa(Workshop shop, const Eigen::Isometry3d& T, double width) {
  begin_object(shop.mesh, "sofa");
  const double depth = shop.random.uniform(0.75, 0.95);
  const double seat = shop.random.uniform(0.36, 0.45);
  const double back = shop.random.uniform(0.65, 0.9);
  const double arm = shop.random.uniform(0.12, 0.22);
  add_box(shop.mesh, T * at(0, 0, 0.08), {width, depth, seat - 0.18});
  for (const double side : {-0.5, 0.5}) {
    const double x = side * (width - arm);
    add_blob(shop.mesh,
             T * at(x, 0.0, 0.3),
             {.radii = {0.5 * arm, 0.5 * depth, 0.32},
              .squareness_z = 0.3,
              .squareness_xy = 0.3,
              .detail = 10});
  }
  Eigen::Isometry3d T_back = T * at(0, 0.4 * depth, 0.5 * back);
  T_back.rotate(Eigen::AngleAxisd(-0.12, Eigen::Vector3d::UnitX()));
  add_blob(shop.mesh,
           T_back,
           {.radii = {0.5 * width, 0.12, 0.5 * back},
            .squareness_z = 0.3,
            .squareness_xy = 0.2,
            .detail = 10});
  const int cushions = std::max(1, static_cast<int>(width / 0.7));
  const double each = (width - 2.0 * arm) / cushions;
  for (int i = 0; i < cushions; ++i) {
    add_blob(shop.mesh,
             T * at((i + 0.5) * each - 0.5 * width + arm, -0.06, seat - 0.02),
             {.radii = {0.49 * each, 0.42 * depth, 0.1},
              .squareness_z = 0.5,
              .squareness_xy = 0.25,
              .roughness = 0.04,
              .seed = shop.random.next(),
              .detail = 10});
  }
}

void add_low_table(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "low table");
  const double height = shop.random.uniform(0.35, 0.5);
  if (shop.random.uniform() < 0.5) {
    const double r = shop.random.uniform(0.3, 0.55);
    add_cylinder(shop.mesh, T * at(0, 0, height - 0.03), r, 0.03);
    add_cylinder(shop.mesh, T, 0.06, height - 0.03);
    add_cylinder(shop.mesh, T, 0.5 * r, 0.03);
  } else {
    const double w = shop.random.uniform(0.7, 1.2);
    add_box(shop.mesh, T * at(0, 0, height - 0.04), {w, 0.6, 0.04});
    for (const double x : {-0.45, 0.45}) {
      for (const double y : {-0.25, 0.25}) {
        add_box(shop.mesh, T * at(x * w, y), {0.05, 0.05, height - 0.04});
      }
    }
  }
  add_box(shop.mesh,
          T * at(0.1, 0.05, height, shop.random.uniform(0.0, 3.0)),
          {0.3, 0.21, shop.random.uniform(0.01, 0.08)});
  const Eigen::Vector2d vase[] = {
      {0.05, 0.0}, {0.08, 0.06}, {0.07, 0.14}, {0.03, 0.2}, {0.045, 0.24}};
  if (shop.random.uniform() < 0.6) {
    add_revolution(shop.mesh, T * at(-0.15, -0.1, height), vase, 14);
  }
}

void add_plant(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "plant");
  const double r = shop.random.uniform(0.16, 0.32);
  const double pot = shop.random.uniform(0.3, 0.6);
  const Eigen::Vector2d profile[] = {
      {0.7 * r, 0.0}, {r, pot}, {1.08 * r, pot}, {1.08 * r, pot + 0.03}, {0.5 * r, pot + 0.01}};
  add_revolution(shop.mesh, T, profile, 20);
  const double height = shop.random.uniform(0.7, 1.7);
  add_rod(shop.mesh,
          T,
          {0, 0, pot},
          {shop.random.uniform(-0.1, 0.1), shop.random.uniform(-0.1, 0.1), pot + 0.6 * height},
          0.025);
  const int leaves = 9 + static_cast<int>(shop.random.below(9));
  for (int i = 0; i < leaves; ++i) {
    const double angle = 2.4 * i + shop.random.uniform(-0.4, 0.4);
    const double up = shop.random.uniform(0.15, 1.0) * height;
    const double out = shop.random.uniform(0.12, 0.38) * (1.3 - up / height);
    Eigen::Isometry3d T_leaf =
        T * at(out * std::cos(angle), out * std::sin(angle), pot + up, angle);
    T_leaf.rotate(Eigen::AngleAxisd(shop.random.uniform(-0.9, 0.9), Eigen::Vector3d::UnitY()));
    add_blob(shop.mesh,
             T_leaf,
             {.radii = {shop.random.uniform(0.12, 0.3), shop.random.uniform(0.05, 0.12), 0.02},
              .squareness_z = 1.0,
              .squareness_xy = 1.4,
              .detail = 5});
  }
}

void add_floor_lamp(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "floor lamp");
  const double height = shop.random.uniform(1.4, 1.9);
  add_cylinder(shop.mesh, T, 0.16, 0.03);
  add_cylinder(shop.mesh, T, 0.015, height);
  const Eigen::Vector2d shade[] = {{0.22, height - 0.05}, {0.12, height + 0.25}};
  add_revolution(shop.mesh, T, shade, 20);
}

void add_bench(Workshop shop, const Eigen::Isometry3d& T, double width) {
  begin_object(shop.mesh, "bench");
  const double seat = shop.random.uniform(0.4, 0.48);
  for (int i = 0; i < 3; ++i) {
    add_box(shop.mesh, T * at(0.0, -0.15 + 0.15 * i, seat - 0.03), {width, 0.12, 0.03});
  }
  for (const double side : {-0.4, 0.4}) {
    add_box(shop.mesh, T * at(side * width, 0.0), {0.07, 0.4, seat - 0.03});
  }
  if (shop.random.uniform() < 0.5) {
    Eigen::Isometry3d T_back = T * at(0.0, 0.22, seat + 0.05);
    T_back.rotate(Eigen::AngleAxisd(-0.2, Eigen::Vector3d::UnitX()));
    add_box(shop.mesh, T_back, {width, 0.03, 0.35});
  }
}

void add_reception(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "reception desk");
  const double radius = shop.random.uniform(1.6, 2.4);
  const double half_angle = shop.random.uniform(0.7, 1.2);
  const auto arc = [&](double inner, double outer, double z, double height) {
    constexpr int kParts = 16;
    for (int i = 0; i < kParts; ++i) {
      const auto point = [&](double r, int k) {
        const double angle = -0.5 * std::numbers::pi + half_angle * (2.0 * k / kParts - 1.0);
        return Eigen::Vector2d(r * std::cos(angle), radius + r * std::sin(angle));
      };
      const std::vector<Eigen::Vector2d> outline = {
          point(inner, i), point(outer, i), point(outer, i + 1), point(inner, i + 1)};
      add_prism(shop.mesh, T * at(0, 0, z), outline, height);
    }
  };
  arc(radius - 0.08, radius, 0.0, 1.08);
  arc(radius - 0.3, radius + 0.08, 1.08, 0.04);
  arc(radius - 0.75, radius - 0.08, 0.72, 0.03);
  arc(radius, radius + 0.03, 0.3, 0.25);  // a panel on the front
  for (int i = 0; i < 2; ++i) {
    const double angle = -0.5 * std::numbers::pi + shop.random.uniform(-0.6, 0.6) * half_angle;
    const double r = radius - 0.45;
    add_box(shop.mesh,
            T * at(r * std::cos(angle),
                   radius + r * std::sin(angle),
                   0.75,
                   angle + 0.5 * std::numbers::pi),
            {0.5, 0.06, 0.4});
    add_office_chair(shop,
                     T * at((r - 0.7) * std::cos(angle),
                            radius + (r - 0.7) * std::sin(angle),
                            0.0,
                            angle + 0.5 * std::numbers::pi + shop.random.uniform(-0.5, 0.5)));
  }
}

void add_vending_machine(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "vending machine");
  const double width = shop.random.uniform(0.75, 1.0);
  const double height = shop.random.uniform(1.75, 1.95);
  add_box(shop.mesh, T * at(0, 0, 0.05), {width, 0.75, height});
  add_box(shop.mesh, T * at(-0.1, -0.39, 0.7), {0.65 * width, 0.04, 0.55 * height});
  add_box(shop.mesh, T * at(0.38 * width, -0.39, 0.9), {0.15, 0.06, 0.4});
  add_box(shop.mesh, T * at(-0.1, -0.4, 0.25), {0.5 * width, 0.06, 0.2});
}

void add_kiosk(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "kiosk");
  const double height = shop.random.uniform(1.0, 1.3);
  add_box(shop.mesh, T, {0.5, 0.4, 0.04});
  add_tapered_box(shop.mesh, T, {0.4, 0.25, height}, 0.7);
  Eigen::Isometry3d T_screen = T * at(0, -0.02, height);
  T_screen.rotate(Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitX()));
  add_box(shop.mesh, T_screen, {0.5, 0.06, 0.4});
}

}  // namespace landmarkdb::datasets
