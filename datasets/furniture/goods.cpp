#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {

void add_crates(Workshop shop, const Eigen::Isometry3d& T, int count) {
  begin_object(shop.mesh, "crates");
  double z = 0.0;
  double x = 0.0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d size(shop.random.uniform(0.2, 0.6),
                               shop.random.uniform(0.2, 0.5),
                               shop.random.uniform(0.12, 0.45));
    add_box(shop.mesh,
            T * at(x + shop.random.uniform(-0.06, 0.06),
                   shop.random.uniform(-0.08, 0.08),
                   z,
                   shop.random.uniform(-0.5, 0.5)),
            size);
    z += size.z();
    if (z > 1.3 || shop.random.uniform() < 0.35) {
      z = 0.0;
      x += 0.55;
    }
  }
}

void add_barrel(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "barrel");
  const double r = shop.random.uniform(0.22, 0.32);
  const double h = shop.random.uniform(0.6, 0.95);
  std::vector<Eigen::Vector2d> profile;
  for (int i = 0; i <= 8; ++i) {
    const double t = i / 8.0;
    profile.emplace_back(r * (0.85 + 0.15 * std::sin(std::numbers::pi * t)), h * t);
  }
  add_revolution(shop.mesh, T, profile, 24);
}

void add_car(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "car");
  const double length = shop.random.uniform(3.6, 4.9);
  const double width = shop.random.uniform(1.65, 1.9);
  const double height = shop.random.uniform(1.4, 1.85);
  const double waist = 0.56 * height;
  add_blob(shop.mesh,
           T * at(0, 0, 0.5 * (waist + 0.2)),
           {.radii = {0.5 * width, 0.5 * length, 0.5 * (waist - 0.2)},
            .squareness_z = 0.3,
            .squareness_xy = 0.25,
            .detail = 16});
  const double cabin = shop.random.uniform(0.45, 0.7) * length;
  add_tapered_box(shop.mesh,
                  T * at(0, shop.random.uniform(0.0, 0.1) * length, waist - 0.05),
                  {0.92 * width, cabin, height - waist + 0.05},
                  shop.random.uniform(0.6, 0.8));
  for (const double x : {-0.5, 0.5}) {
    for (const double y : {-0.31, 0.31}) {
      const Eigen::Vector3d hub(x * (width - 0.1), y * length, 0.31);
      add_rod(
          shop.mesh, T, hub - Eigen::Vector3d(0.1, 0, 0), hub + Eigen::Vector3d(0.1, 0, 0), 0.31);
    }
    add_box(shop.mesh, T * at(x * (width + 0.12), -0.18 * length, waist), {0.16, 0.08, 0.12});
  }
}

void add_rack(Workshop shop, const Eigen::Isometry3d& T, double length, double height) {
  begin_object(shop.mesh, "rack");
  constexpr double kDepth_m = 0.9;
  constexpr double kBay_m = 2.2;
  const int bays = std::max(1, static_cast<int>(length / kBay_m));
  const int levels = std::max(2, static_cast<int>(height / 1.1));
  for (int i = 0; i <= bays; ++i) {
    for (const double y : {-0.5, 0.5}) {
      add_box(shop.mesh, T * at(kBay_m * (i - 0.5 * bays), y * kDepth_m), {0.08, 0.08, height});
    }
  }
  for (int level = 0; level < levels; ++level) {
    const double z = 0.12 + (height - 0.3) * level / levels;
    for (int i = 0; i < bays; ++i) {
      const double x = kBay_m * (i + 0.5 - 0.5 * bays);
      for (const double y : {-0.5, 0.5}) {
        add_box(shop.mesh, T * at(x, y * kDepth_m, z - 0.1), {kBay_m, 0.05, 0.1});
      }
      double at_x = x - 0.5 * kBay_m + 0.1;
      while (at_x < x + 0.5 * kBay_m - 0.3) {  // boxes of all sizes, and gaps
        const double wide = shop.random.uniform(0.25, 0.9);
        if (at_x + wide > x + 0.5 * kBay_m - 0.05) break;
        if (shop.random.uniform() < 0.75) {
          add_box(shop.mesh,
                  T * at(at_x + 0.5 * wide,
                         shop.random.uniform(-0.1, 0.1),
                         z,
                         shop.random.uniform(-0.08, 0.08)),
                  {0.95 * wide,
                   shop.random.uniform(0.4, 0.85),
                   (height / levels - 0.2) * shop.random.uniform(0.25, 0.9)});
        }
        at_x += wide + 0.04;
      }
    }
  }
}

void add_pallet(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "pallet");
  for (int i = 0; i < 5; ++i) {
    add_box(shop.mesh, T * at(-0.5 + 0.25 * i, 0.0, 0.1), {0.14, 0.8, 0.04});
  }
  for (const double y : {-0.35, 0.0, 0.35}) add_box(shop.mesh, T * at(0.0, y), {1.2, 0.1, 0.1});
  if (shop.random.uniform() < 0.8) {
    add_crates(shop, T * at(-0.25, 0.0, 0.14), 2 + static_cast<int>(shop.random.below(6)));
  }
}

void add_ladder(Workshop shop, const Eigen::Isometry3d& T) {
  begin_object(shop.mesh, "ladder");
  const double height = shop.random.uniform(1.6, 2.2);
  for (const double lean : {-0.45, 0.45}) {
    for (const double x : {-0.22, 0.22}) {
      add_rod(shop.mesh, T, {x, lean, 0.0}, {0.8 * x, 0.0, height}, 0.025);
    }
  }
  for (double z = 0.28; z < height - 0.1; z += 0.28) {
    const double y = -0.45 * (1.0 - z / height);
    add_box(shop.mesh, T * at(0.0, y, z), {0.4, 0.08, 0.025});
  }
}

void add_clutter(Workshop shop, const Eigen::Isometry3d& T) {
  switch (shop.random.below(11)) {
    case 0:
      return add_bin(shop, T);
    case 1:
      return add_office_chair(shop, T);
    case 2:
      return add_plant(shop, T);
    case 3:
      return add_floor_lamp(shop, T);
    case 4:
      return add_barrel(shop, T);
    case 5:
      return add_kiosk(shop, T);
    case 6:
      return add_ladder(shop, T);
    case 7:
      return add_low_table(shop, T);
    case 8: {  // a bag
      begin_object(shop.mesh, "bag");
      return add_blob(shop.mesh,
                      T * at(0, 0, 0.22),
                      {.radii = {shop.random.uniform(0.18, 0.32), 0.16, 0.25},
                       .squareness_z = 0.7,
                       .squareness_xy = 0.8,
                       .roughness = 0.2,
                       .seed = shop.random.next()});
    }
    default:
      return add_crates(shop, T, 1 + static_cast<int>(shop.random.below(3)));
  }
}

}  // namespace landmarkdb::datasets
