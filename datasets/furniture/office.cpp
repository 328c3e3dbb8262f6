#include <cmath>
#include <numbers>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kBoard_m = 0.03;  // thickness of table tops and shelf boards

void add_monitor(Workshop shop, const Eigen::Isometry3d& T) {
  const double width = shop.random.uniform(0.42, 0.7);
  const double height = 0.6 * width;
  add_box(shop.mesh, T, {0.24, 0.18, 0.015});
  add_box(shop.mesh, T * at(0.0, 0.04, 0.015), {0.05, 0.03, 0.12 + 0.5 * height});
  Eigen::Isometry3d T_screen = T * at(0.0, 0.0, 0.12);
  T_screen.rotate(Eigen::AngleAxisd(-0.1, Eigen::Vector3d::UnitX()));
  add_box(shop.mesh, T_screen, {width, 0.035, height});
}

// Paper piles, cups, a keyboard: low things on a table of this size.
void add_desk_litter(Workshop shop, const Eigen::Isometry3d& T, double width, double depth) {
  const int count = 2 + static_cast<int>(shop.random.below(5));
  for (int i = 0; i < count; ++i) {
    const Eigen::Isometry3d T_thing = T * at(shop.random.uniform(-0.42, 0.42) * width,
                                             shop.random.uniform(-0.4, 0.05) * depth,
                                             0.0,
                                             shop.random.uniform(-1.0, 1.0));
    if (shop.random.uniform() < 0.3) {
      add_cylinder(
          shop.mesh, T_thing, shop.random.uniform(0.03, 0.05), shop.random.uniform(0.08, 0.25));
    } else {
      add_box(shop.mesh,
              T_thing,
              {shop.random.uniform(0.15, 0.35),
               shop.random.uniform(0.12, 0.25),
               shop.random.uniform(0.015, 0.16)});
    }
  }
}

// Books or boxes side by side on a board.
void fill_board(Workshop shop, const Eigen::Isometry3d& T, double width, double depth, double gap) {
  double x = -0.5 * width + shop.random.uniform(0.0, 0.15);
  while (x < 0.5 * width - 0.06) {
    if (shop.random.uniform() < 0.22) {  // an empty stretch
      x += shop.random.uniform(0.1, 0.4);
      continue;
    }
    const double wide = std::min(shop.random.uniform(0.04, 0.38), 0.5 * width - x);
    const double deep = depth * shop.random.uniform(0.5, 0.95);
    const double high = gap * shop.random.uniform(0.3, 0.92);
    add_box(shop.mesh,
            T * at(x + 0.5 * wide, 0.5 * (depth - deep) - 0.01, 0.0),
            {wide * 0.96, deep, high});
    x += wide + shop.random.uniform(0.0, 0.02);
  }
}

}  // namespace

void add_office_chair(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "chair");
  const double seat = shop.random.uniform(0.42, 0.52);
  for (int i = 0; i < 5; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 5.0;
    add_rod(
        shop.mesh, T, {0.0, 0.0, 0.1}, {0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.05}, 0.025);
  }
  add_cylinder(shop.mesh, T * at(0, 0, 0.08), 0.03, seat - 0.1);
  add_blob(shop.mesh,
           T * at(0, 0, seat),
           {.radii = {0.25, 0.24, 0.05}, .squareness_z = 0.5, .squareness_xy = 0.5, .detail = 8});
  Eigen::Isometry3d T_back = T * at(0, 0.24, seat + 0.35);
  T_back.rotate(Eigen::AngleAxisd(-shop.random.uniform(0.08, 0.25), Eigen::Vector3d::UnitX()));
  add_blob(shop.mesh,
           T_back,
           {.radii = {0.22, 0.04, shop.random.uniform(0.22, 0.34)},
            .squareness_z = 0.5,
            .squareness_xy = 0.5,
            .detail = 8});
  if (shop.random.uniform() < 0.6) {
    for (const double side : {-0.27, 0.27}) {
      add_box(shop.mesh, T * at(side, 0.0, seat + 0.2), {0.06, 0.28, 0.03});
      add_box(shop.mesh, T * at(side, 0.03, seat), {0.03, 0.05, 0.2});
    }
  }
}

void add_desk(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "desk");
  const double width = shop.random.uniform(1.2, 1.8);
  const double depth = shop.random.uniform(0.7, 0.85);
  const double height = shop.random.uniform(0.71, 0.76);
  add_box(shop.mesh, T * at(0, 0, height - kBoard_m), {width, depth, kBoard_m});
  for (const double side : {-1.0, 1.0}) {
    add_box(shop.mesh,
            T * at(side * (0.5 * width - 0.04), 0.0),
            {0.04, depth - 0.1, height - kBoard_m});
  }
  add_box(shop.mesh, T * at(0, 0.35 * depth, 0.3), {width - 0.1, 0.02, height - 0.35});
  if (shop.random.uniform() < 0.7) {
    const double side = shop.random.uniform() < 0.5 ? -1.0 : 1.0;
    add_box(shop.mesh, T * at(side * (0.5 * width - 0.3), 0.0), {0.42, 0.55, 0.56});
  }
  const Eigen::Isometry3d T_top = T * at(0, 0, height);
  const int monitors = static_cast<int>(shop.random.below(3));
  for (int i = 0; i < monitors; ++i) {
    add_monitor(shop,
                T_top * at((i - 0.5 * (monitors - 1)) * 0.6,
                           0.15 * depth,
                           0.0,
                           shop.random.uniform(-0.3, 0.3)));
  }
  add_desk_litter(shop, T_top, width, depth);
  if (shop.random.uniform() < 0.85) {
    add_office_chair(shop,
                     T * at(shop.random.uniform(-0.3, 0.3),
                            -0.5 * depth - shop.random.uniform(0.05, 0.4),
                            0.0,
                            std::numbers::pi + shop.random.uniform(-1.0, 1.0)));
  }
}

void add_shelf(Workshop shop, const Eigen::Isometry3d& T, double width) {
  begin_object(shop.mesh, "shelf");
  const double depth = shop.random.uniform(0.28, 0.45);
  const double height = shop.random.uniform(1.1, 2.3);
  const int boards = 2 + static_cast<int>(height / 0.42);
  for (const double side : {-0.5, 0.5}) {
    add_box(shop.mesh, T * at(side * width, 0.0), {kBoard_m, depth, height});
  }
  add_box(shop.mesh, T * at(0.0, 0.5 * depth), {width, 0.012, height});
  for (int i = 0; i < boards; ++i) {
    const double gap = (height - 0.08) / (boards - 1);
    const double z = 0.05 + gap * i;
    add_box(shop.mesh, T * at(0.0, 0.0, z), {width, depth, kBoard_m});
    if (i + 1 < boards || shop.random.uniform() < 0.5) {
      fill_board(shop, T * at(0.0, 0.0, z + kBoard_m), width - 0.05, depth, gap - kBoard_m);
    }
  }
}

void add_cabinet(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "cabinet");
  const double width = shop.random.uniform(0.5, 1.1);
  const double depth = shop.random.uniform(0.4, 0.6);
  const double height = shop.random.uniform(0.7, 2.0);
  add_box(shop.mesh, T, {width, depth, height});
  const int drawers = 1 + static_cast<int>(shop.random.below(5));
  for (int i = 0; i < drawers; ++i) {
    const double gap = (height - 0.06) / drawers;
    add_box(shop.mesh,
            T * at(0.0, -0.5 * depth - 0.01, 0.04 + gap * i),
            {width - 0.06, 0.025, gap - 0.03});
    add_box(
        shop.mesh, T * at(0.0, -0.5 * depth - 0.03, 0.04 + gap * (i + 0.6)), {0.16, 0.025, 0.02});
  }
  if (shop.random.uniform() < 0.6) {
    add_box(shop.mesh,
            T * at(0.0, 0.0, height, shop.random.uniform(-0.3, 0.3)),
            {0.6 * width, 0.6 * depth, shop.random.uniform(0.1, 0.4)});
  }
}

void add_bin(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "bin");
  const double r = shop.random.uniform(0.12, 0.22);
  const double h = shop.random.uniform(0.3, 0.75);
  const Eigen::Vector2d profile[] = {
      {0.8 * r, 0.0}, {r, h}, {r, h + 0.02}, {0.9 * r, h + 0.02}, {0.85 * r, 0.75 * h}};
  add_revolution(shop.mesh, T, profile, 20);
}

void add_partition(Workshop shop, const Eigen::Isometry3d& T, double length) {
  begin_object(shop.mesh, "partition");
  const double height = shop.random.uniform(1.2, 1.6);
  add_box(shop.mesh, T * at(0, 0, 0.08), {length, 0.05, height - 0.08});
  for (const double side : {-0.45, 0.45}) {
    add_box(shop.mesh, T * at(side * length, 0.0), {0.05, 0.4, 0.05});
  }
}

void add_table_with_chairs(Workshop shop, const Eigen::Isometry3d& T, double length, int seats) {
  begin_object(shop.mesh, "table");
  const double height = 0.74;
  add_box(shop.mesh, T * at(0, 0, height - 0.04), {length, 1.1, 0.04});
  for (const double side : {-0.3, 0.3}) {
    add_cylinder(shop.mesh, T * at(side * length, 0.0), 0.06, height - 0.04);
    add_box(shop.mesh, T * at(side * length, 0.0), {0.5, 0.7, 0.03});
  }
  add_desk_litter(shop, T * at(0, 0.2, height), length, 1.0);
  for (int i = 0; i < seats; ++i) {
    const double side = i % 2 == 0 ? -1.0 : 1.0;
    const double x = length * ((i / 2 + 0.5) / ((seats + 1) / 2) - 0.5);
    add_office_chair(shop,
                     T * at(x + shop.random.uniform(-0.12, 0.12),
                            side * shop.random.uniform(0.75, 1.1),
                            0.0,
                            (side < 0 ? std::numbers::pi : 0.0) + shop.random.uniform(-0.6, 0.6)));
  }
}

}  // namespace landmarkdb::datasets
