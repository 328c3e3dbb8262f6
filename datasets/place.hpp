#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "datasets/ray_caster.hpp"
#include "datasets/triangle_mesh.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::datasets {

enum class PlaceType { kLobby, kTemple, kOffice, kCorridor, kHall, kStorage };

// All types, in the order of the enumeration.
std::span<const PlaceType> all_place_types();
std::string_view place_type_name(PlaceType type);  // "lobby", ...
// What stands in a place of this type, in one line.
std::string_view place_type_summary(PlaceType type);
// Throws Error{kInvalidArgument} that lists the names there are.
PlaceType place_type_from_name(std::string_view name);

// How much the floors of one building differ.
enum class FloorCopies {
  kLookAlike,      // the same architecture, other furniture
  kOneDifference,  // the same in everything but one small group of things
  kExact,          // the same up to a translation: a frame cannot tell them apart
};

struct PlaceOptions {
  PlaceType type = PlaceType::kLobby;
  std::uint64_t seed = 1;  // same options, same place, bit for bit
  double size = 1.0;       // 0.3..3: scales floor area by its square, not the things in it
  double clutter = 1.0;    // 0..4: how much loose clutter stands around
  int floors = 0;          // 1..20; 0: one, but three of a corridor
  FloorCopies copies = FloorCopies::kLookAlike;
  // Another number: the same building on another day; loose clutter stands elsewhere.
  std::uint64_t day = 0;
  // Another number: another building of the same plan; furniture and clutter differ.
  std::uint64_t twin = 0;
  int stations = 0;  // of the laser scanner, per floor; 0: as many as suit the type
};

// A rectangle of floor where a person or a scanner may stand, if nothing else stands there.
struct StandingArea {
  Eigen::Isometry3d T_scene_area;  // origin at a corner on the floor, z up
  Eigen::Vector2d size_m;          // along its x and y
  int floor = 0;
};

// A building with everything in it. Scene frame: metres, z up (`up`), the floor of the lowest
// storey at z = 0; walls stand at an angle to x and y, as in real scans.
struct Place {
  std::string name;
  PlaceOptions options;
  TriangleMesh mesh;
  std::vector<StandingArea> areas;
  std::vector<Eigen::Isometry3d> stations;  // T_scene_station of the laser scanner, z up
  std::vector<Landmark> landmarks;          // a few named boxes, scene frame
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double floor_height_m = 0.0;              // from one storey's floor to the next
  std::shared_ptr<const RayCaster> caster;  // of `mesh`
};

// Builds the place the options describe. Throws Error{kInvalidArgument} for options out of the
// ranges above.
Place make_place(const PlaceOptions& options);

}  // namespace landmarkdb::datasets
