#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/furniture/furniture.hpp"
#include "datasets/place.hpp"
#include "datasets/shapes/shapes.hpp"
#include "engine/base/random.hpp"

// What the builders of all types of place share. Everything here is in the frame of one storey:
// its floor at z = 0, walls along x and y.
namespace landmarkdb::datasets {

struct Disc {
  double x = 0.0, y = 0.0, radius = 0.0;
};

// One storey as it grows.
struct Storey {
  PlaceOptions options;
  TriangleMesh mesh;
  Random plan;     // architecture: the same on all storeys
  Random furnish;  // furniture: another one on each storey that only looks alike
  Random loose;    // clutter: another one each day
  double height_m = 3.0;
  std::vector<StandingArea> areas;
  std::vector<Disc> taken;  // floor that something stands on

  Workshop planner() { return {mesh, plan}; }
  Workshop furnisher() { return {mesh, furnish}; }
  Workshop clutterer() { return {mesh, loose}; }
};

// Which part of a wall a thing needs: furniture below, pictures above, a door both.
enum class Band { kLow, kHigh, kBoth };

struct WallRun {
  Eigen::Isometry3d T_storey_wall;  // x along the wall, z up, the room towards -y
  double length_m = 0.0, height_m = 0.0;
  std::vector<std::pair<double, double>> low, high;  // stretches in use
  std::vector<Opening> openings;
};

// The walls of a room with these corners, clockwise seen from above.
std::vector<WallRun> walls_between(std::span<const Eigen::Vector2d> corners, double height_m);

// A free stretch of `width_m` on the wall, now in use: where it begins. Nothing where it is full.
std::optional<double> reserve(WallRun& wall, Random& random, double width_m, Band band);
// The same at a place of the caller's choice; false when in use.
bool reserve_at(WallRun& wall, double x0, double width_m, Band band);

// Floor and ceiling over the box of the corners, and the walls with their openings.
void build_shell(Storey& storey,
                 std::span<const Eigen::Vector2d> corners,
                 std::span<const WallRun> walls);

// Openings, to be made before build_shell; false when there is no room for one.
bool open_door(WallRun& wall, Random& random, double depth_m);
bool open_window(WallRun& wall, Random& random, double sill_m, double top_m);

// Frames and handles of the doors made above, after build_shell.
void fit_doors(Storey& storey, std::span<const WallRun> walls);

// `count` pictures, switchboards, signs and the like, on any of the walls.
void decorate_walls(Storey& storey, std::span<WallRun> walls, int count);

// A free disc of the rectangle [x0, x1] x [y0, y1], now in use.
std::optional<Eigen::Vector2d> find_spot(Storey& storey,
                                         Random& random,
                                         const Eigen::AlignedBox2d& within,
                                         double radius_m);
bool take(Storey& storey, double x, double y, double radius_m);

// Loose clutter, `per_m2` things a square metre at clutter 1.
void scatter_clutter(Storey& storey, const Eigen::AlignedBox2d& within, double per_m2);

void add_area(Storey& storey, const Eigen::AlignedBox2d& rectangle, double z = 0.0);

// Fills one storey; one function a type.
void build_lobby(Storey& storey);
void build_temple(Storey& storey);
void build_office(Storey& storey);
void build_corridor(Storey& storey);
void build_hall(Storey& storey);
void build_storage(Storey& storey);

}  // namespace landmarkdb::datasets
