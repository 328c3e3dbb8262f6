#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kRailing_m = 1.0;  // must not come out of the floor above

struct Plan {
  double length, width, bay_x0, bay_x1, bay_depth;
  std::vector<Eigen::Vector2d> corners;
};

Plan draw_plan(Storey& storey) {
  Random& random = storey.plan;
  Plan plan{};
  plan.length = random.uniform(22.0, 32.0) * storey.options.size;
  plan.width = random.uniform(2.0, 2.7);
  plan.bay_x0 = plan.length * random.uniform(0.25, 0.5);
  plan.bay_x1 = plan.bay_x0 + std::min(random.uniform(4.5, 6.5), 0.4 * plan.length);
  plan.bay_depth = random.uniform(3.0, 4.5);
  storey.height_m = random.uniform(2.6, 3.1);
  const double w = plan.width;
  plan.corners = {{0, 0},
                  {0, w},
                  {plan.bay_x0, w},
                  {plan.bay_x0, w + plan.bay_depth},
                  {plan.bay_x1, w + plan.bay_depth},
                  {plan.bay_x1, w},
                  {plan.length, w},
                  {plan.length, 0}};
  return plan;
}

void cut_doors(Storey& storey, std::vector<WallRun>& walls) {
  Random& random = storey.plan;
  const double recess = random.uniform(0.12, 0.4);
  for (WallRun& wall : walls) {
    const int doors = std::max(1, static_cast<int>(wall.length_m / random.uniform(2.6, 4.0)));
    for (int i = 0; i < doors && wall.length_m > 1.6; ++i) open_door(wall, random, recess);
  }
  open_window(walls[0], random, 0.9, 2.2);
}

void furnish_walls(Storey& storey, std::vector<WallRun>& walls) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  for (WallRun& wall : walls) {
    const int things = static_cast<int>(wall.length_m / 3.2);
    for (int i = 0; i < things; ++i) {
      const double width = random.uniform(0.5, 1.4);
      const auto x0 = reserve(wall, random, width, Band::kBoth);
      if (!x0) continue;
      const Eigen::Isometry3d T = wall.T_storey_wall * at(*x0 + 0.5 * width, 0.0);
      const Eigen::Isometry3d T_stand = T * at(0.0, -0.28, 0.0, random.uniform(-0.03, 0.03));
      switch (random.below(7)) {
        case 0:
          add_radiator(shop, T, width);
          continue;
        case 1:
          add_extinguisher(shop, T);
          continue;
        case 2:
          add_wall_box(shop, T * at(0, 0, random.uniform(0.4, 1.2)));
          continue;
        case 3:
          add_bench(shop, T_stand, width);
          break;
        case 4:
          add_cabinet(shop, T_stand);
          break;
        case 5:
          add_shelf(shop, T_stand, width);
          break;
        default:
          add_plant(shop, T_stand);
      }
      storey.taken.push_back({T_stand.translation().x(), T_stand.translation().y(), 0.5 * width});
    }
  }
}

void add_ceiling(Storey& storey, const Plan& plan) {
  Random& random = storey.plan;
  const double spacing = random.uniform(2.2, 3.4);
  for (double x = 1.0; x < plan.length - 0.5; x += spacing) {
    add_ceiling_lamp(storey.planner(), at(x, 0.5 * plan.width, storey.height_m));
  }
  add_pipe_run(storey.planner(), at(0.2, 0.05, storey.height_m), plan.length - 0.4);
  begin_object(storey.mesh, "lintels");
  const double door_x = plan.length * random.uniform(0.65, 0.85);  // a fire door, held open
  add_box(
      storey.mesh, at(door_x, 0.5 * plan.width, storey.height_m - 0.45), {0.2, plan.width, 0.45});
  for (const double y : {0.06, plan.width - 0.06}) {
    add_box(storey.mesh, at(door_x, y), {0.2, 0.12, storey.height_m});
  }
  add_box(storey.mesh,
          at(door_x + 0.55, plan.width - 0.2, 0.0, random.uniform(-0.08, 0.08)),
          {0.95, 0.05, 2.05});
}

void furnish_bay(Storey& storey, const Plan& plan) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  const Eigen::AlignedBox2d bay(
      Eigen::Vector2d(plan.bay_x0 + 1.9, plan.width + 0.2),
      Eigen::Vector2d(plan.bay_x1 - 0.3, plan.width + plan.bay_depth - 0.3));
  if (const auto spot = find_spot(storey, random, bay, 0.7)) {
    const Eigen::Isometry3d T = at(spot->x(), spot->y(), 0.0, random.uniform(0.0, 6.3));
    add_low_table(shop, T);
    add_sofa(shop, T * at(0.0, 1.0), random.uniform(1.2, 1.6));
  }
  for (int i = 0; i < 3; ++i) {
    if (const auto spot = find_spot(storey, random, bay, 0.4)) {
      add_clutter(shop, at(spot->x(), spot->y(), 0.0, random.uniform(0.0, 6.3)));
    }
  }
}

}  // namespace

void build_corridor(Storey& storey) {
  const Plan plan = draw_plan(storey);
  std::vector<WallRun> walls = walls_between(plan.corners, storey.height_m);
  cut_doors(storey, walls);
  build_shell(storey, plan.corners, walls);
  fit_doors(storey, walls);
  // Stairs in the bay, as far up as the ceiling lets one see.
  add_stairs(storey.planner(),
             at(plan.bay_x0 + 0.85, plan.width + 0.4),
             1.3,
             std::min(storey.height_m - kRailing_m, (plan.bay_depth - 0.5) / 0.29 * 0.17));
  storey.taken.push_back({plan.bay_x0 + 0.85, plan.width + 0.5 * plan.bay_depth, 1.2});
  add_ceiling(storey, plan);
  furnish_walls(storey, walls);
  furnish_bay(storey, plan);
  decorate_walls(storey, walls, static_cast<int>(plan.length * 0.7));
  const Eigen::AlignedBox2d way(Eigen::Vector2d(0.3, 0.3),
                                Eigen::Vector2d(plan.length - 0.3, plan.width - 0.3));
  scatter_clutter(storey, way, 0.05);
  add_area(storey, way);
  add_area(storey,
           {Eigen::Vector2d(plan.bay_x0 + 0.3, plan.width),
            Eigen::Vector2d(plan.bay_x1 - 0.3, plan.width + plan.bay_depth - 0.3)});
}

}  // namespace landmarkdb::datasets
