#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kBay_m = 5.4;  // from column to column, the same all over the hall

void add_columns_and_beams(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  const double size = random.uniform(0.35, 0.5);
  for (double x = kBay_m; x < length - 1.0; x += kBay_m) {
    for (double y = kBay_m; y < width - 1.0; y += kBay_m) {
      add_square_column(storey.planner(), at(x, y), size, storey.height_m);
      storey.taken.push_back({x, y, 0.5});
    }
  }
  begin_object(storey.mesh, "ceiling beams");
  for (double x = kBay_m; x < length - 1.0; x += kBay_m) {
    add_box(storey.mesh, at(x, 0.5 * width, storey.height_m - 0.45), {size, width, 0.45});
  }
}

void add_cars(Storey& storey, double length, double width) {
  Random& random = storey.loose;
  for (double y = 2.8; y < width - 2.4; y += 2.0 * kBay_m) {
    for (double x = 1.6; x < length - 1.2; x += 2.6) {
      begin_object(storey.mesh, "wheel stop");
      add_tapered_box(storey.mesh, at(x, y + 2.1), {1.6, 0.15, 0.1}, 0.8);
      if (random.uniform() > 0.55) continue;
      const bool clear =
          std::none_of(storey.taken.begin(), storey.taken.end(), [&](const Disc& disc) {
            return std::hypot(disc.x - x, disc.y - y) < disc.radius + 1.3;
          });
      if (!clear) continue;
      add_car(storey.clutterer(),
              at(x + random.uniform(-0.15, 0.15),
                 y + random.uniform(-0.3, 0.3),
                 0.0,
                 (random.uniform() < 0.5 ? 0.0 : std::numbers::pi) + random.uniform(-0.06, 0.06)));
      for (const double dy : {-1.5, 0.0, 1.5}) storey.taken.push_back({x, y + dy, 1.0});
    }
  }
}

// The stairs and the lift stand in a box of their own.
void add_core(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  const double x = length * random.uniform(0.3, 0.7);
  const double y = width - 2.0;
  begin_object(storey.mesh, "stair core");
  add_box(storey.mesh, at(x, y + 0.5), {5.0, 3.0, storey.height_m});
  add_door_frame(storey.planner(), at(x - 1.8, y - 1.0), 1.0, 2.1);
  add_door_frame(storey.planner(), at(x + 0.5, y - 1.0), 1.3, 2.2);
  add_wall_box(storey.planner(), at(x - 0.2, y - 1.0, 1.0));
  for (double dx = -2.5; dx <= 2.5; dx += 1.0) storey.taken.push_back({x + dx, y, 1.4});
}

void add_services(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  add_duct(
      storey.planner(), at(1.0, random.uniform(0.2, 0.4) * width, storey.height_m), length - 2.0);
  add_pipe_run(
      storey.planner(), at(0.5, random.uniform(0.5, 0.8) * width, storey.height_m), length - 1.0);
  for (double x = 0.5 * kBay_m; x < length; x += kBay_m) {
    for (double y = 0.5 * kBay_m; y < width; y += kBay_m) {
      add_ceiling_lamp(storey.planner(), at(x, y, storey.height_m));
    }
  }
}

}  // namespace

void build_hall(Storey& storey) {
  Random& random = storey.plan;
  const double length = random.uniform(26.0, 36.0) * storey.options.size;
  const double width = random.uniform(16.0, 22.0) * storey.options.size;
  storey.height_m = random.uniform(2.7, 3.3);
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {0, width}, {length, width}, {length, 0}};
  std::vector<WallRun> walls = walls_between(corners, storey.height_m);
  for (WallRun& wall : walls) {
    open_door(wall, random, 0.15);
    open_window(wall, random, 1.8, 2.4);
    open_window(wall, random, 1.8, 2.4);
  }
  reserve_at(walls[0], 0.4 * width, 4.6, Band::kBoth);
  walls[0].openings.push_back(
      {.x0 = 0.4 * width, .x1 = 0.4 * width + 4.2, .z0 = 0.0, .z1 = 2.5, .depth_m = 1.8});
  build_shell(storey, corners, walls);
  fit_doors(storey, walls);
  add_core(storey, length, width);
  add_columns_and_beams(storey, length, width);
  add_services(storey, length, width);
  add_cars(storey, length, width);
  decorate_walls(storey, walls, 24);
  const Eigen::AlignedBox2d all(Eigen::Vector2d(0.5, 0.5),
                                Eigen::Vector2d(length - 0.5, width - 0.5));
  scatter_clutter(storey, all, 0.02);
  add_area(storey, all);
}

}  // namespace landmarkdb::datasets
