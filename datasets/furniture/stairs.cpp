#include <algorithm>
#include <cmath>

#include "datasets/furniture/furniture.hpp"

namespace landmarkdb::datasets {

void add_railing(Workshop shop, const Eigen::Isometry3d& T, double length) {
  begin_object(shop.mesh, "railing");
  constexpr double kHeight_m = 1.0;
  const int posts = std::max(2, static_cast<int>(std::ceil(length / 1.2)) + 1);
  for (int i = 0; i < posts; ++i) {
    add_cylinder(shop.mesh, T * at(length * i / (posts - 1), 0.0), 0.025, kHeight_m);
  }
  for (const double z : {0.3, 0.55, 0.8}) {
    add_rod(shop.mesh, T, {0.0, 0.0, z}, {length, 0.0, z}, 0.012);
  }
  add_rod(shop.mesh, T, {0.0, 0.0, kHeight_m}, {length, 0.0, kHeight_m}, 0.03);
}

void add_stairs(Workshop shop, const Eigen::Isometry3d& T, double width, double height) {
  begin_object(shop.mesh, "stairs");
  const int steps = std::max(2, static_cast<int>(std::lround(height / 0.17)));
  const double rise = height / steps;
  constexpr double kTread_m = 0.29;
  for (int i = 0; i < steps; ++i) {  // a step and its share of the body below
    const double foot = std::max(0.0, rise * (i - 1) - 0.15);
    add_box(shop.mesh,
            T * at(0.0, kTread_m * (i + 0.5), foot),
            {width, kTread_m, rise * (i + 1) - foot});
    add_box(
        shop.mesh, T * at(0.0, kTread_m * i - 0.01, rise * (i + 1) - 0.03), {width, 0.03, 0.03});
  }
  const double run = kTread_m * steps;
  for (const double side : {-0.5, 0.5}) {
    const double x = side * (width - 0.06);
    for (int i = 0; i <= steps; i += 4) {
      const double y = std::min(kTread_m * (i + 0.5), run - 0.1);
      add_rod(shop.mesh,
              T,
              {x, y, rise * std::min(i + 1, steps)},
              {x, y, rise * std::min(i + 1, steps) + 0.9},
              0.02);
    }
    add_rod(shop.mesh, T, {x, 0.1, rise + 0.9}, {x, run - 0.1, height + 0.9}, 0.03);
  }
}

}  // namespace landmarkdb::datasets
