#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

void add_racks(Storey& storey, double length, double width) {
  Random& random = storey.furnish;
  const double aisle = storey.plan.uniform(3.2, 4.0);
  const double rack_length = length - 6.5;
  const double rack_height = storey.height_m * storey.plan.uniform(0.6, 0.8);
  for (double y = 2.6; y < width - 1.5; y += aisle) {
    add_rack(storey.furnisher(), at(0.5 * length - 1.0, y), rack_length, rack_height);
    for (double x = 0.5 * (length - rack_length) - 1.0; x < 0.5 * (length + rack_length) - 1.0;
         x += 0.7) {
      storey.taken.push_back({x, y, 0.65});
    }
    if (random.uniform() < 0.5) {  // the next rack back to back
      add_rack(storey.furnisher(), at(0.5 * length - 1.0, y + 1.0), rack_length, rack_height);
    }
  }
}

// The foreman's cabin: a box with a counter window.
void add_cabin(Storey& storey, double length, double width) {
  const double w = storey.plan.uniform(2.4, 3.2);
  const Eigen::Isometry3d T = at(length - 1.5, width - 0.5 * w - 0.3, 0.0, 0.0);
  begin_object(storey.mesh, "cabin");
  add_box(storey.mesh, T, {2.4, w, 2.5});
  add_box(storey.mesh, T * at(-1.25, 0.0, 1.0), {0.35, 1.2, 0.04});
  add_box(storey.mesh, T * at(-1.22, 0.0, 1.1), {0.06, 1.0, 0.8});
  add_box(storey.mesh, T * at(0.0, 0.0, 2.5), {2.6, w + 0.2, 0.12});
  for (double y = -1.5; y <= 1.5; y += 0.75) {
    storey.taken.push_back({T.translation().x(), T.translation().y() + y, 1.4});
  }
}

void add_shutters(Storey& storey, const WallRun& wall, double x0, double width) {
  begin_object(storey.mesh, "shutter");
  for (double z = 0.1; z < 3.0; z += 0.22) {
    add_rod(storey.mesh, wall.T_storey_wall, {x0, 0.32, z}, {x0 + width, 0.32, z}, 0.07);
  }
}

}  // namespace

void build_storage(Storey& storey) {
  Random& random = storey.plan;
  const double length = random.uniform(16.0, 24.0) * std::max(0.6, storey.options.size);
  const double width = random.uniform(11.0, 16.0) * std::max(0.6, storey.options.size);
  storey.height_m = random.uniform(4.8, 6.8);
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {0, width}, {length, width}, {length, 0}};
  std::vector<WallRun> walls = walls_between(corners, storey.height_m);
  std::vector<double> gates;
  for (int i = 0; i < 2; ++i) {
    if (const auto x0 = reserve(walls[2], random, 3.2, Band::kBoth)) {
      walls[2].openings.push_back(
          {.x0 = *x0, .x1 = *x0 + 3.0, .z0 = 0.0, .z1 = 3.1, .depth_m = 0.35});
      gates.push_back(*x0);
    }
  }
  for (WallRun& wall : walls) {
    open_door(wall, random, 0.12);
    open_window(wall, random, 3.6, storey.height_m - 0.5);
    open_window(wall, random, 3.6, storey.height_m - 0.5);
  }
  build_shell(storey, corners, walls);
  fit_doors(storey, walls);
  for (const double x0 : gates) add_shutters(storey, walls[2], x0, 3.0);
  add_cabin(storey, length, width);
  add_racks(storey, length, width);
  begin_object(storey.mesh, "roof trusses");
  for (double x = 1.5; x < length; x += random.uniform(2.6, 3.4)) {
    add_box(storey.mesh, at(x, 0.5 * width, storey.height_m - 0.5), {0.16, width, 0.16});
    for (double y = 0.2; y < width - 0.6; y += 1.0) {
      add_rod(
          storey.mesh, at(x, y), {0, 0, storey.height_m - 0.42}, {0, 0.5, storey.height_m}, 0.03);
    }
  }
  for (int i = 0; i < 6; ++i) {
    add_pendant_lamp(
        storey.planner(),
        at(random.uniform(1.0, length - 1.0), random.uniform(1.0, width - 1.0), storey.height_m),
        random.uniform(0.5, 0.9));
  }
  const Eigen::AlignedBox2d all(Eigen::Vector2d(0.5, 0.5),
                                Eigen::Vector2d(length - 0.5, width - 0.5));
  for (int i = 0; i < 7; ++i) {
    if (const auto spot = find_spot(storey, storey.furnish, all, 0.8)) {
      add_pallet(storey.furnisher(),
                 at(spot->x(), spot->y(), 0.0, storey.furnish.uniform(0.0, 6.3)));
    }
  }
  decorate_walls(storey, walls, 16);
  scatter_clutter(storey, all, 0.05);
  add_area(storey, all);
}

}  // namespace landmarkdb::datasets
