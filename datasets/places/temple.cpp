#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "datasets/places/builder.hpp"

namespace landmarkdb::datasets {
namespace {

// A carved panel on a wall: bands of relief that fade out at the rim.
void add_relief(Storey& storey, const WallRun& wall, double x0, double z0, Eigen::Vector2d size) {
  begin_object(storey.mesh, "relief");
  const std::uint64_t seed = storey.plan.next();
  const double bands = storey.plan.uniform(0.35, 0.6);
  constexpr double kDeep_m = 0.05;
  constexpr double kStep_m = 0.05;
  const auto height = [=](double x, double y) {
    const double rim = std::min({x, size.x() - x, y, size.y() - y});
    const double fade = std::clamp(rim / 0.06, 0.0, 1.0);
    const double figure = smooth_noise({4.0 * x, 4.0 * y, 0.5}, seed);
    const double band = std::fmod(y, bands) < 0.06 ? 0.4 : 0.0;
    return fade * kDeep_m * (0.8 + 0.8 * figure + band);
  };
  Eigen::Isometry3d T = wall.T_storey_wall * at(x0, 0.0, z0);
  T.rotate(Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitX()));
  add_sheet(storey.mesh, T, size, kStep_m, height);
}

void cut_niches(Storey& storey, WallRun& wall, int count, std::vector<Eigen::Isometry3d>& niches) {
  Random& random = storey.plan;
  for (int i = 0; i < count; ++i) {
    const double width = random.uniform(0.9, 1.5);
    const auto x0 = reserve(wall, random, width + 0.2, Band::kBoth);
    if (!x0) continue;
    const double sill = random.uniform(0.25, 0.7);
    const double depth = random.uniform(0.45, 0.8);
    wall.openings.push_back({.x0 = *x0 + 0.1,
                             .x1 = *x0 + 0.1 + width,
                             .z0 = sill,
                             .z1 = std::min(sill + random.uniform(1.5, 2.1), wall.height_m - 0.4),
                             .depth_m = depth});
    niches.push_back(wall.T_storey_wall *
                     at(*x0 + 0.1 + 0.5 * width, 0.5 * depth, sill, random.uniform(-0.2, 0.2)));
  }
}

void add_rough_floor_and_ceiling(Storey& storey, double length, double width) {
  const std::uint64_t seed = storey.plan.next();
  constexpr double kSlab_m = 0.35;
  begin_object(storey.mesh, "paving");
  add_sheet(storey.mesh, at(0, 0, 0.02), {length, width}, kSlab_m, [=](double x, double y) {
    return 0.018 * smooth_noise({x, y, 0.5}, seed);
  });
  begin_object(storey.mesh, "vault");
  Eigen::Isometry3d T = at(0.0, width, storey.height_m - 0.05);
  T.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  add_sheet(storey.mesh, T, {length, width}, 0.3, [=](double x, double y) {
    return 0.08 * smooth_noise({0.8 * x, 0.8 * y, 7.5}, seed);
  });
}

void add_colonnade(Storey& storey, double length, double width) {
  Random& random = storey.plan;
  const int columns = std::max(2, static_cast<int>(length / random.uniform(2.4, 3.0)));
  const double radius = random.uniform(0.24, 0.38);
  const double span = random.uniform(0.2, 0.26) * width;
  for (int i = 0; i < columns; ++i) {
    for (const double side : {-1.0, 1.0}) {
      const double x = length * (i + 0.5) / columns + random.uniform(-0.08, 0.08);
      const double y = 0.5 * width + side * span;
      if (random.uniform() < 0.1) {  // a broken one
        add_round_column(storey.planner(), at(x, y), radius, random.uniform(0.9, 1.8));
      } else {
        add_round_column(storey.planner(), at(x, y), radius, storey.height_m - 0.45);
      }
      take(storey, x, y, radius + 0.3);
    }
  }
  begin_object(storey.mesh, "architraves");
  for (const double side : {-1.0, 1.0}) {
    add_box(storey.mesh,
            at(0.5 * length, 0.5 * width + side * span, storey.height_m - 0.45),
            {length, 2.4 * radius, 0.45});
  }
}

void furnish(Storey& storey, double length, double width, std::vector<WallRun>& walls) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  for (WallRun& wall : walls) {
    for (int i = 0; i < 2; ++i) {
      const auto x0 = reserve(wall, random, 1.2, Band::kBoth);
      if (!x0) continue;
      const Eigen::Isometry3d T =
          wall.T_storey_wall * at(*x0 + 0.6, -0.45, 0.0, random.uniform(-0.15, 0.15));
      storey.taken.push_back({T.translation().x(), T.translation().y(), 0.5});
      switch (random.below(3)) {
        case 0:
          add_stele(shop, T);
          break;
        case 1:
          add_statue(shop, T, random.uniform(1.5, 2.4));
          break;
        default:
          add_urn(shop, T);
      }
    }
  }
  const Eigen::AlignedBox2d inner(Eigen::Vector2d(0.5, 0.5),
                                  Eigen::Vector2d(length - 0.5, width - 0.5));
  for (int i = 0; i < 4; ++i) {
    if (const auto spot = find_spot(storey, random, inner, 0.45)) {
      add_urn(shop, at(spot->x(), spot->y()));
    }
  }
  if (const auto spot = find_spot(storey, random, inner, 0.6)) {
    add_statue(shop, at(spot->x(), spot->y(), 0.0, random.uniform(0.0, 6.3)), 1.9);
  }
}

void scatter_rubble(Storey& storey, double length, double width) {
  const auto heaps = static_cast<int>(std::lround(length * width * 0.05 * storey.options.clutter));
  const Eigen::AlignedBox2d inner(Eigen::Vector2d(0.3, 0.3),
                                  Eigen::Vector2d(length - 0.3, width - 0.3));
  for (int i = 0; i < heaps; ++i) {
    if (const auto spot = find_spot(storey, storey.loose, inner, 0.5)) {
      add_rubble(storey.clutterer(),
                 at(spot->x(), spot->y(), 0.0, storey.loose.uniform(0.0, 6.3)),
                 1 + static_cast<int>(storey.loose.below(5)));
    }
  }
}

}  // namespace

void build_temple(Storey& storey) {
  Random& random = storey.plan;
  const double length = random.uniform(9.0, 12.5) * storey.options.size;
  const double width = random.uniform(7.0, 9.5) * storey.options.size;
  storey.height_m = random.uniform(4.0, 5.5);
  const std::vector<Eigen::Vector2d> corners = {{0, 0}, {0, width}, {length, width}, {length, 0}};
  std::vector<WallRun> walls = walls_between(corners, storey.height_m);
  // The way in lies opposite the altar; a side chamber's dark mouth on one long wall.
  const double gate = random.uniform(0.3, 0.5) * width;
  reserve_at(walls[0], gate, 1.7, Band::kBoth);
  walls[0].openings.push_back(
      {.x0 = gate + 0.1, .x1 = gate + 1.6, .z0 = 0.0, .z1 = 2.7, .depth_m = 1.6});
  if (const auto x0 = reserve(walls[1], random, 1.4, Band::kBoth)) {
    walls[1].openings.push_back(
        {.x0 = *x0 + 0.1, .x1 = *x0 + 1.2, .z0 = 0.0, .z1 = 2.0, .depth_m = 1.9});
  }
  std::vector<Eigen::Isometry3d> niches;
  cut_niches(storey, walls[1], 2, niches);
  cut_niches(storey, walls[3], 3, niches);
  cut_niches(storey, walls[2], 1, niches);
  build_shell(storey, corners, walls);
  add_rough_floor_and_ceiling(storey, length, width);
  for (const Eigen::Isometry3d& T : niches) {
    if (random.uniform() < 0.8) add_statue(storey.planner(), T, random.uniform(1.0, 1.4));
  }
  const double altar_y = width * random.uniform(0.44, 0.56);
  add_altar(storey.planner(), at(length - 1.9, altar_y, 0.0, -0.5 * std::numbers::pi));
  storey.taken.push_back({length - 1.9, altar_y, 2.2});
  add_colonnade(storey, length, width);
  furnish(storey, length, width, walls);
  for (WallRun& wall : walls) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector2d size(random.uniform(1.0, 2.2), random.uniform(1.0, 2.0));
      if (const auto x0 = reserve(wall, random, size.x(), Band::kHigh)) {
        add_relief(storey, wall, *x0, random.uniform(0.7, 1.3), size);
      }
    }
  }
  scatter_rubble(storey, length, width);
  add_area(storey, {Eigen::Vector2d(0.4, 0.4), Eigen::Vector2d(length - 0.4, width - 0.4)});
}

}  // namespace landmarkdb::datasets
