#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

void cut_openings(Storey& storey, std::vector<WallRun>& walls) {
  Random& random = storey.plan;
  WallRun& windows = walls.back();
  const int count = std::max(1, static_cast<int>(windows.length_m / 2.3));
  for (int i = 0; i < count; ++i) open_window(windows, random, 0.85, storey.height_m - 0.35);
  open_door(walls[1], random, random.uniform(0.05, 0.15));
  open_door(walls[1], random, random.uniform(0.05, 0.15));
  if (random.uniform() < 0.5) open_door(walls[0], random, 0.1);
  if (random.uniform() < 0.5) open_window(walls[2], random, 0.95, 2.2);
}

// A room within the room: two walls with a door and a window, a table inside.
void add_meeting_room(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  const double l = random.uniform(0.28, 0.38) * length;
  const double w = random.uniform(0.42, 0.55) * width;
  constexpr double kThick_m = 0.12;
  const double x0 = length - l;
  const double y0 = width - w;
  begin_object(storey.mesh, "partition wall");
  const double door = random.uniform(0.3, w - 1.4);
  add_wall(storey.mesh,
           at(x0, y0, 0.0, 0.5 * std::numbers::pi),
           {.length_m = w,
            .height_m = storey.height_m,
            .thickness_m = kThick_m,
            .openings = {{.x0 = door, .x1 = door + 0.95, .z0 = 0.0, .z1 = 2.1, .through = true}}});
  begin_object(storey.mesh, "partition wall");
  add_wall(storey.mesh,
           at(x0, y0, 0.0, 0.0),
           {.length_m = l,
            .height_m = storey.height_m,
            .thickness_m = kThick_m,
            .openings = {{.x0 = 0.5, .x1 = l - 0.6, .z0 = 1.0, .z1 = 2.0, .through = true}}});
  add_table_with_chairs(storey.furnisher(),
                        at(x0 + 0.5 * l, y0 + 0.52 * w, 0.0, random.uniform(-0.1, 0.1)),
                        std::max(1.2, l - 1.8),
                        4 + static_cast<int>(storey.furnish.below(4)));
  for (double x = x0; x < length; x += 0.6) {
    for (double y = y0; y < width; y += 0.6) storey.taken.push_back({x, y, 0.45});
  }
}

void add_desks(Storey& storey, double length, double width) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  const double pitch_x = random.uniform(2.0, 2.5);
  const double pitch_y = random.uniform(3.0, 3.6);
  for (double y = 1.9; y < width - 1.2; y += pitch_y) {
    for (double x = 1.7; x < length - 1.2; x += pitch_x) {
      if (random.uniform() < 0.15) continue;  // nobody sits there
      if (!take(storey, x, y, 1.0)) continue;
      const double turn = random.uniform(-0.07, 0.07);
      add_desk(shop, at(x + random.uniform(-0.1, 0.1), y - 0.42, 0.0, turn));
      if (random.uniform() < 0.8) {
        add_desk(shop, at(x + random.uniform(-0.1, 0.1), y + 0.42, 0.0, std::numbers::pi + turn));
      }
      if (random.uniform() < 0.4) add_partition(shop, at(x, y), random.uniform(1.3, 1.8));
    }
  }
}

void add_ceiling(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  for (double x = 1.2; x < length - 0.6; x += 2.4) {
    for (double y = 1.2; y < width - 0.6; y += 2.6) {
      add_ceiling_lamp(storey.planner(),
                       at(x, y, storey.height_m, random.uniform() < 0.1 ? 1.57 : 0.0));
    }
  }
  begin_object(storey.mesh, "ceiling beam");
  add_box(storey.mesh,
          at(length * random.uniform(0.35, 0.6), 0.5 * width, storey.height_m - 0.22),
          {0.35, width, 0.22});
  if (random.uniform() < 0.6) {
    add_pipe_run(storey.planner(), at(0.3, width - 0.7, storey.height_m), length - 0.6);
  }
}

void furnish_walls(Storey& storey, std::vector<WallRun>& walls) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  for (WallRun& wall : walls) {
    const int things = static_cast<int>(wall.length_m / 1.8);
    for (int i = 0; i < things; ++i) {
      const double width = random.uniform(0.7, 1.6);
      const bool tall = random.uniform() < 0.5 && &wall != &walls.back();
      const auto x0 = reserve(wall, random, width, tall ? Band::kBoth : Band::kLow);
      if (!x0) continue;
      const Eigen::Isometry3d T = wall.T_storey_wall * at(*x0 + 0.5 * width, 0.0);
      if (&wall == &walls.back()) {
        add_radiator(shop, T, width);
        continue;
      }
      const Eigen::Isometry3d T_thing = T * at(0.0, -0.32, 0.0, random.uniform(-0.03, 0.03));
      storey.taken.push_back({T_thing.translation().x(), T_thing.translation().y(), 0.5 * width});
      if (tall) {
        add_shelf(shop, T_thing, width);
      } else if (random.uniform() < 0.7) {
        add_cabinet(shop, T_thing);
      } else {
        add_plant(shop, T_thing);
      }
    }
  }
}

}  // namespace

void build_office(Storey& storey) {
  Random& random = storey.plan;
  const double length = random.uniform(9.0, 13.0) * storey.options.size;
  const double width = random.uniform(7.0, 9.5) * storey.options.size;
  storey.height_m = random.uniform(2.7, 3.2);
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {0, width}, {length, width}, {length, 0}};
  std::vector<WallRun> walls = walls_between(corners, storey.height_m);
  cut_openings(storey, walls);
  build_shell(storey, corners, walls);
  fit_doors(storey, walls);
  if (length > 7.0 && width > 6.0) add_meeting_room(storey, length, width);
  const double column_x = length * random.uniform(0.3, 0.5);
  add_square_column(storey.planner(), at(column_x, 0.52 * width), 0.4, storey.height_m);
  take(storey, column_x, 0.52 * width, 0.5);
  add_ceiling(storey, length, width);
  furnish_walls(storey, walls);
  add_desks(storey, length, width);
  decorate_walls(storey, walls, 14);
  const Eigen::AlignedBox2d all(Eigen::Vector2d(0.4, 0.4),
                                Eigen::Vector2d(length - 0.4, width - 0.4));
  scatter_clutter(storey, all, 0.08);
  add_area(storey, all);
}

}  // namespace landmarkdb::datasets
