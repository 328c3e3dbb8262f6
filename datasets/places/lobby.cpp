#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

struct Plan {
  double length, width, notch_x, notch_y, mezzanine_depth, mezzanine_z;
  std::vector<Eigen::Vector2d> corners;
};

Plan draw_plan(Storey& storey) {
  Random& random = storey.plan;
  Plan plan{};
  plan.length = random.uniform(17.5, 23.0) * storey.options.size;
  plan.width = random.uniform(14.0, 18.0) * storey.options.size;
  storey.height_m = random.uniform(5.4, 7.5);
  plan.notch_x = random.uniform(0.12, 0.25) * plan.length;
  plan.notch_y = random.uniform(0.12, 0.25) * plan.width;
  plan.mezzanine_depth = random.uniform(2.4, 3.6);
  plan.mezzanine_z = random.uniform(2.8, 3.2);
  const double l = plan.length;
  const double w = plan.width;
  plan.corners = {{0, 0}, {0, w}};
  switch (random.below(3)) {
    case 0:
      plan.corners.insert(plan.corners.end(), {{l, w}});
      break;
    case 1:  // a corner cut off at an angle
      plan.corners.insert(plan.corners.end(), {{l - plan.notch_x, w}, {l, w - plan.notch_y}});
      break;
    default:  // a corner taken by another room
      plan.corners.insert(
          plan.corners.end(),
          {{l - plan.notch_x, w}, {l - plan.notch_x, w - plan.notch_y}, {l, w - plan.notch_y}});
  }
  plan.corners.push_back({l, 0});
  return plan;
}

void cut_openings(Storey& storey, std::vector<WallRun>& walls) {
  Random& random = storey.plan;
  WallRun& front = walls.back();
  // A double entrance, and glazing in bays beside it.
  const double entrance = random.uniform(0.35, 0.6) * front.length_m;
  reserve_at(front, entrance, 2.2, Band::kBoth);
  front.openings.push_back(
      {.x0 = entrance + 0.1, .x1 = entrance + 2.1, .z0 = 0.0, .z1 = 2.4, .depth_m = 0.6});
  const double bay = random.uniform(2.0, 2.8);
  for (double x = random.uniform(0.3, 0.8); x + bay < front.length_m; x += bay + 0.35) {
    if (!reserve_at(front, x, bay, Band::kHigh)) continue;
    front.openings.push_back(
        {.x0 = x,
         .x1 = x + bay,
         .z0 = random.uniform(0.35, 0.45),
         .z1 = storey.height_m - 1.2,
         .depth_m = 0.3,
         .material = random.uniform() < 0.55 ? Material::kGlass : Material::kOpaque});
  }
  // A deep recess in the first wall, doors in all but the front.
  const double recess = random.uniform(2.5, 4.0);
  if (const auto x0 = reserve(walls[0], random, recess, Band::kBoth)) {
    walls[0].openings.push_back(
        {.x0 = *x0, .x1 = *x0 + recess, .z0 = 0.0, .z1 = 2.6, .depth_m = 1.2});
  }
  for (std::size_t i = 0; i + 1 < walls.size(); ++i) {
    const int doors = 1 + static_cast<int>(random.below(3));
    for (int k = 0; k < doors; ++k) open_door(walls[i], random, random.uniform(0.08, 0.3));
    if (random.uniform() < 0.5) open_window(walls[i], random, 3.6, storey.height_m - 0.6);
  }
}

void add_columns(Storey& storey, const Plan& plan) {
  Random& random = storey.plan;
  const bool round = random.uniform() < 0.6;
  const double size = random.uniform(0.24, 0.4);
  const int columns = std::max(2, static_cast<int>(plan.length / 5.5));
  for (int i = 0; i < columns; ++i) {
    for (const double share : {0.3, 0.68}) {
      const double x = plan.length * (i + 0.5) / columns + random.uniform(-0.15, 0.15);
      const double y = plan.width * share;
      if (!take(storey, x, y, 0.6)) continue;
      if (round) {
        add_round_column(storey.planner(), at(x, y), size, storey.height_m);
      } else {
        add_square_column(storey.planner(),
                          at(x, y, 0.0, random.uniform(-0.05, 0.05)),
                          2 * size,
                          storey.height_m);
      }
    }
  }
}

void add_mezzanine(Storey& storey, const Plan& plan) {
  Random& random = storey.plan;
  const double x0 = random.uniform(2.2, 3.2);
  const double x1 = plan.length - plan.notch_x - 0.3;
  const double edge = plan.width - plan.mezzanine_depth;
  begin_object(storey.mesh, "mezzanine");
  add_box(storey.mesh,
          at(0.5 * (x0 + x1), 0.5 * (edge + plan.width), plan.mezzanine_z - 0.3),
          {x1 - x0, plan.mezzanine_depth, 0.3});
  add_railing(storey.planner(), at(x0, edge + 0.06, plan.mezzanine_z), x1 - x0);
  for (double x = x0 + 0.5; x < x1; x += 3.1) {
    add_square_column(storey.planner(), at(x, edge + 0.3), 0.25, plan.mezzanine_z - 0.3);
    take(storey, x, edge + 0.3, 0.35);
  }
  const double run = 0.29 * std::round(plan.mezzanine_z / 0.17);
  add_stairs(storey.planner(), at(x0 - 0.8, plan.width - run - 0.4), 1.5, plan.mezzanine_z);
  for (double y = plan.width - run; y < plan.width; y += 0.8) {
    storey.taken.push_back({x0 - 0.8, y, 0.9});
  }
  for (int i = 0; i < 4; ++i) {  // what stands up there
    add_clutter(storey.furnisher(),
                at(storey.furnish.uniform(x0 + 0.6, x1 - 0.6),
                   storey.furnish.uniform(edge + 0.8, plan.width - 0.6),
                   plan.mezzanine_z,
                   storey.furnish.uniform(0.0, 6.3)));
  }
}

void add_ceiling(Storey& storey, const Plan& plan) {
  Random& random = storey.plan;
  const double spacing = random.uniform(2.2, 3.2);
  const double deep = random.uniform(0.3, 0.55);
  begin_object(storey.mesh, "ceiling beams");
  for (double x = 0.6 * spacing; x < plan.length; x += spacing) {
    add_box(storey.mesh,
            at(x, 0.5 * plan.width, storey.height_m - deep),
            {random.uniform(0.22, 0.35), plan.width, deep});
  }
  add_box(storey.mesh,
          at(0.5 * plan.length, 0.47 * plan.width, storey.height_m - 0.7 * deep),
          {plan.length, 0.3, 0.7 * deep});
  add_duct(storey.planner(),
           at(1.0, plan.width * random.uniform(0.12, 0.22), storey.height_m - deep),
           plan.length - 2.5);
  const int lamps = 6 + static_cast<int>(random.below(6));
  for (int i = 0; i < lamps; ++i) {
    add_pendant_lamp(storey.planner(),
                     at(random.uniform(1.0, plan.length - plan.notch_x - 1.0),
                        random.uniform(1.0, plan.width - plan.mezzanine_depth - 1.0),
                        storey.height_m),
                     random.uniform(0.8, 2.4));
  }
}

void add_seating(Storey& storey, const Eigen::AlignedBox2d& within) {
  Random& random = storey.furnish;
  const auto spot = find_spot(storey, random, within, 2.0);
  if (!spot) return;
  const Workshop shop = storey.furnisher();
  const Eigen::Isometry3d T = at(spot->x(), spot->y(), 0.0, random.uniform(0.0, 6.3));
  add_low_table(shop, T);
  const int seats = 2 + static_cast<int>(random.below(3));
  for (int i = 0; i < seats; ++i) {
    const double turn = 0.5 * std::numbers::pi * i + random.uniform(-0.15, 0.15);
    const double width = random.uniform() < 0.5 ? random.uniform(1.5, 2.1) : 0.85;
    add_sofa(shop,
             T * at(0, 0, 0, turn) * at(random.uniform(-0.2, 0.2), random.uniform(1.1, 1.4)),
             width);
  }
  if (random.uniform() < 0.5) add_plant(shop, T * at(1.3, 1.3));
}

void furnish(Storey& storey, const Plan& plan, std::vector<WallRun>& walls) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  const Eigen::AlignedBox2d inner(
      Eigen::Vector2d(0.8, 0.8),
      Eigen::Vector2d(plan.length - 0.8, plan.width - plan.mezzanine_depth - 0.2));
  if (const auto spot = find_spot(storey, random, inner, 2.6)) {
    add_reception(shop, at(spot->x(), spot->y() - 1.5, 0.0, random.uniform(-0.5, 0.5)));
  }
  const int groups = 2 + static_cast<int>(plan.length * plan.width / 110.0);
  for (int i = 0; i < groups; ++i) add_seating(storey, inner);
  for (WallRun& wall : walls) {
    for (int i = 0; i < 3; ++i) {
      const double width = random.uniform(0.9, 2.0);
      const auto x0 = reserve(wall, random, width, Band::kLow);
      if (!x0) continue;
      const Eigen::Isometry3d T =
          wall.T_storey_wall * at(*x0 + 0.5 * width, -0.42, 0.0, random.uniform(-0.04, 0.04));
      storey.taken.push_back({T.translation().x(), T.translation().y(), 0.5 * width});
      switch (random.below(5)) {
        case 0:
          add_bench(shop, T, width);
          break;
        case 1:
          add_vending_machine(shop, T);
          break;
        case 2:
          add_shelf(shop, T, width);
          break;
        case 3:
          add_cabinet(shop, T);
          break;
        default:
          add_plant(shop, T);
      }
    }
  }
  for (int i = 0; i < 5; ++i) {
    if (const auto spot = find_spot(storey, random, inner, 0.6)) {
      add_plant(shop, at(spot->x(), spot->y()));
    }
  }
  if (const auto spot = find_spot(storey, random, inner, 1.0)) {  // a sculpture
    add_statue(shop, at(spot->x(), spot->y(), 0.0, random.uniform(0.0, 6.3)), 2.2);
  }
}

}  // namespace

void build_lobby(Storey& storey) {
  const Plan plan = draw_plan(storey);
  std::vector<WallRun> walls = walls_between(plan.corners, storey.height_m);
  cut_openings(storey, walls);
  build_shell(storey, plan.corners, walls);
  fit_doors(storey, walls);
  add_mezzanine(storey, plan);
  add_columns(storey, plan);
  add_ceiling(storey, plan);
  furnish(storey, plan, walls);
  decorate_walls(storey, walls, 22);
  const Eigen::AlignedBox2d all(Eigen::Vector2d(0.5, 0.5),
                                Eigen::Vector2d(plan.length - 0.5, plan.width - 0.5));
  scatter_clutter(storey, all, 0.06);
  add_area(storey, all);
}

}  // namespace landmarkdb::datasets
