#include "datasets/places/builder.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace landmarkdb::datasets {
namespace {

constexpr int kTries = 40;  // to find room for a thing before it is left out
constexpr double kGap_m = 0.08;

bool is_clear(const std::vector<std::pair<double, double>>& used, double x0, double x1) {
  return std::none_of(
      used.begin(), used.end(), [&](const auto& u) { return x0 < u.second && u.first < x1; });
}

}  // namespace

std::vector<WallRun> walls_between(std::span<const Eigen::Vector2d> corners, double height_m) {
  std::vector<WallRun> walls;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d way = corners[(i + 1) % corners.size()] - corners[i];
    WallRun wall;
    wall.T_storey_wall = at(corners[i].x(), corners[i].y(), 0.0, std::atan2(way.y(), way.x()));
    wall.length_m = way.norm();
    wall.height_m = height_m;
    walls.push_back(wall);
  }
  return walls;
}

bool reserve_at(WallRun& wall, double x0, double width_m, Band band) {
  const double x1 = x0 + width_m;
  if (x0 < 0.0 || x1 > wall.length_m) return false;
  if (band != Band::kHigh && !is_clear(wall.low, x0, x1)) return false;
  if (band != Band::kLow && !is_clear(wall.high, x0, x1)) return false;
  if (band != Band::kHigh) wall.low.emplace_back(x0 - kGap_m, x1 + kGap_m);
  if (band != Band::kLow) wall.high.emplace_back(x0 - kGap_m, x1 + kGap_m);
  return true;
}

std::optional<double> reserve(WallRun& wall, Random& random, double width_m, Band band) {
  if (width_m + 0.2 >= wall.length_m) return std::nullopt;
  for (int i = 0; i < kTries; ++i) {
    const double x0 = random.uniform(0.1, wall.length_m - width_m - 0.1);
    if (reserve_at(wall, x0, width_m, band)) return x0;
  }
  return std::nullopt;
}

void build_shell(Storey& storey,
                 std::span<const Eigen::Vector2d> corners,
                 std::span<const WallRun> walls) {
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : corners) box.extend(corner);
  const Eigen::Vector2d low = box.min().array() - 0.5;
  const Eigen::Vector2d high = box.max().array() + 0.5;
  const auto p = [](double x, double y, double z) { return Eigen::Vector3d(x, y, z); };
  const double h = storey.height_m;
  begin_object(storey.mesh, "floor");
  add_quad(storey.mesh,
           p(low.x(), low.y(), 0),
           p(high.x(), low.y(), 0),
           p(high.x(), high.y(), 0),
           p(low.x(), high.y(), 0));
  begin_object(storey.mesh, "ceiling");
  add_quad(storey.mesh,
           p(low.x(), high.y(), h),
           p(high.x(), high.y(), h),
           p(high.x(), low.y(), h),
           p(low.x(), low.y(), h));
  for (const WallRun& wall : walls) {
    begin_object(storey.mesh, "wall");
    add_wall(storey.mesh,
             wall.T_storey_wall,
             {.length_m = wall.length_m, .height_m = wall.height_m, .openings = wall.openings});
  }
}

bool open_door(WallRun& wall, Random& random, double depth_m) {
  const double width = random.uniform(0.85, 1.0) * (random.uniform() < 0.2 ? 1.8 : 1.0);
  const auto x0 = reserve(wall, random, width + 0.3, Band::kBoth);
  if (!x0) return false;
  const double top = std::min(random.uniform(2.0, 2.2), wall.height_m - 0.2);
  wall.openings.push_back(
      {.x0 = *x0 + 0.15, .x1 = *x0 + 0.15 + width, .z0 = 0.0, .z1 = top, .depth_m = depth_m});
  return true;
}

bool open_window(WallRun& wall, Random& random, double sill_m, double top_m) {
  const double width = random.uniform(1.0, 2.4);
  const auto x0 = reserve(wall, random, width + 0.2, Band::kHigh);
  if (!x0) return false;
  wall.openings.push_back(
      {.x0 = *x0 + 0.1,
       .x1 = *x0 + 0.1 + width,
       .z0 = sill_m,
       .z1 = top_m,
       .depth_m = random.uniform(0.12, 0.35),
       .material = random.uniform() < 0.5 ? Material::kGlass : Material::kOpaque});
  return true;
}

void fit_doors(Storey& storey, std::span<const WallRun> walls) {
  for (const WallRun& wall : walls) {
    for (const Opening& o : wall.openings) {
      if (o.z0 > 0.0 || o.through || o.depth_m > 1.0) continue;
      // The frame goes round the hole, the handle sits on the leaf at its back.
      const Eigen::Isometry3d T_door = wall.T_storey_wall * at(o.x0, 0.0);
      add_door_frame(storey.planner(), T_door, o.x1 - o.x0, o.z1);
      const double side = storey.plan.uniform() < 0.5 ? 0.1 : o.x1 - o.x0 - 0.1;
      add_box(storey.mesh, T_door * at(side, o.depth_m - 0.04, 1.02), {0.13, 0.08, 0.025});
      if (o.x1 - o.x0 > 1.3) {  // two leaves
        add_box(
            storey.mesh, T_door * at(0.5 * (o.x1 - o.x0), o.depth_m - 0.01), {0.05, 0.04, o.z1});
      }
    }
  }
}

void decorate_walls(Storey& storey, std::span<WallRun> walls, int count) {
  Random& random = storey.furnish;
  const Workshop shop = storey.furnisher();
  for (int i = 0; i < count; ++i) {
    WallRun& wall = walls[random.below(walls.size())];
    const auto place = [&](double width, double z) -> std::optional<Eigen::Isometry3d> {
      const auto x0 = reserve(wall, random, width, Band::kHigh);
      if (!x0) return std::nullopt;
      return wall.T_storey_wall * at(*x0 + 0.5 * width, 0.0, z);
    };
    const std::uint64_t kind = random.below(8);
    if (kind < 3) {
      if (const auto T = place(1.7, random.uniform(1.2, 1.6))) add_picture(shop, *T);
    } else if (kind < 5) {
      const double z = std::max(1.9, wall.height_m - random.uniform(0.8, 1.4));
      if (const auto T = place(1.2, z)) add_vent(shop, *T);
    } else if (kind == 5) {
      if (const auto T = place(0.3, 0.0)) add_extinguisher(shop, *T);
    } else if (kind == 6) {
      if (const auto T = place(1.1, random.uniform(1.0, 1.5))) add_wall_box(shop, *T);
    } else if (const auto T = place(0.3, random.uniform(2.1, 2.3))) {
      add_sign(shop, *T);
    }
  }
}

bool take(Storey& storey, double x, double y, double radius_m) {
  const bool clear = std::none_of(storey.taken.begin(), storey.taken.end(), [&](const Disc& disc) {
    return std::hypot(disc.x - x, disc.y - y) < disc.radius + radius_m;
  });
  if (clear) storey.taken.push_back({x, y, radius_m});
  return clear;
}

std::optional<Eigen::Vector2d> find_spot(Storey& storey,
                                         Random& random,
                                         const Eigen::AlignedBox2d& within,
                                         double radius_m) {
  for (int i = 0; i < kTries; ++i) {
    const double x = random.uniform(within.min().x() + radius_m, within.max().x() - radius_m);
    const double y = random.uniform(within.min().y() + radius_m, within.max().y() - radius_m);
    if (within.contains(Eigen::Vector2d(x, y)) && take(storey, x, y, radius_m)) {
      return Eigen::Vector2d(x, y);
    }
  }
  return std::nullopt;
}

void scatter_clutter(Storey& storey, const Eigen::AlignedBox2d& within, double per_m2) {
  const auto count =
      static_cast<int>(std::lround(within.volume() * per_m2 * storey.options.clutter));
  constexpr double kReach_m = 0.5;
  for (int i = 0; i < count; ++i) {
    const auto spot = find_spot(storey, storey.loose, within, kReach_m);
    if (!spot) return;
    add_clutter(storey.clutterer(), at(spot->x(), spot->y(), 0.0, storey.loose.uniform(0.0, 6.3)));
  }
}

void add_area(Storey& storey, const Eigen::AlignedBox2d& rectangle, double z) {
  storey.areas.push_back({at(rectangle.min().x(), rectangle.min().y(), z), rectangle.sizes(), 0});
}

}  // namespace landmarkdb::datasets
