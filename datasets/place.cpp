#include "datasets/place.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "datasets/places/builder.hpp"
#include "datasets/ray_noise.hpp"
#include "datasets/stations.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kSlab_m = 0.3;  // between a ceiling and the floor above
constexpr int kMaxFloors = 20;

struct TypeEntry {
  PlaceType type;
  std::string_view name, summary;
  int floors, stations;  // what the type has unless asked otherwise
  void (*build)(Storey&);
};

constexpr std::array<TypeEntry, 6> kTypes = {{
    {PlaceType::kLobby,
     "lobby",
     "a tall entrance hall: columns, mezzanine, stairs, reception, sofas, plants, beams, vents",
     1,
     6,
     &build_lobby},
    {PlaceType::kTemple,
     "temple",
     "a chamber of stone: colonnade, niches with statues, reliefs, altar, urns, rubble",
     1,
     5,
     &build_temple},
    {PlaceType::kOffice,
     "office",
     "desks and chairs, a meeting room, shelves of boxes, cabinets, windows, radiators",
     1,
     5,
     &build_office},
    {PlaceType::kCorridor,
     "corridor",
     "storeys that look alike: corridor, recessed doors, a bay with stairs, pipes, cabinets",
     3,
     5,
     &build_corridor},
    {PlaceType::kHall,
     "hall",
     "a car park: the same columns and beams over and over, cars, ducts, a stair core",
     1,
     6,
     &build_hall},
    {PlaceType::kStorage,
     "storage",
     "racks full of boxes, pallets, roller shutters, a cabin, roof trusses",
     1,
     7,
     &build_storage},
}};

const TypeEntry& entry(PlaceType type) { return kTypes[static_cast<std::size_t>(type)]; }

void check(const PlaceOptions& options) {
  const auto refuse = [](const std::string& what, double seen, const std::string& wanted) {
    throw Error(ErrorCode::kInvalidArgument,
                "place: " + what + " is " + std::to_string(seen) + ", want " + wanted);
  };
  if (!(options.size >= 0.3 && options.size <= 3.0)) refuse("size", options.size, "0.3 to 3");
  if (!(options.clutter >= 0.0 && options.clutter <= 4.0)) {
    refuse("clutter", options.clutter, "0 to 4");
  }
  if (options.floors < 0 || options.floors > kMaxFloors) {
    refuse("the number of floors", options.floors, "1 to 20, or 0 for the type's own");
  }
  if (options.stations < 0 || options.stations > 100) {
    refuse("the number of stations", options.stations, "1 to 100 a floor, or 0");
  }
}

std::string name_of(const PlaceOptions& options) {
  std::string name =
      std::string(place_type_name(options.type)) + "-" + std::to_string(options.seed);
  if (options.twin != 0) name += "-twin-" + std::to_string(options.twin);
  if (options.day != 0) name += "-day-" + std::to_string(options.day);
  return name;
}

// Another stream of random numbers for each purpose, storey and day.
std::uint64_t stream(std::uint64_t seed, std::uint64_t purpose, std::uint64_t a, std::uint64_t b) {
  return Random(Random(Random(seed * 31 + purpose).next() ^ (a + 1)).next() ^ (b + 1)).next();
}

Storey make_storey(const PlaceOptions& options, int floor) {
  const bool own = options.copies == FloorCopies::kLookAlike;
  const std::uint64_t which =
      options.twin * kMaxFloors + (own ? static_cast<std::uint64_t>(floor) : 0);
  Storey storey{.options = options,
                .mesh = {},
                .plan = Random(stream(options.seed, 1, 0, 0)),
                .furnish = Random(stream(options.seed, 2, which, 0)),
                .loose = Random(stream(options.seed, 3, which, options.day)),
                .height_m = 3.0,
                .areas = {},
                .taken = {}};
  entry(options.type).build(storey);
  return storey;
}

// The one thing that tells a storey from its copies: a few crates and a lamp.
void add_difference(Storey& storey, int floor) {
  Random random(stream(storey.options.seed, 4, static_cast<std::uint64_t>(floor), 0));
  const StandingArea& area = storey.areas.front();
  const Eigen::Vector3d at_area(
      random.uniform(0.1, 0.9) * area.size_m.x(), random.uniform(0.2, 0.8) * area.size_m.y(), 0.0);
  const Eigen::Vector3d p = area.T_scene_area * at_area;
  const Workshop shop{storey.mesh, random};
  add_crates(shop, at(p.x(), p.y(), p.z(), random.uniform(0.0, 6.3)), 3);
  add_floor_lamp(shop, at(p.x() + 0.5, p.y() + 0.3, p.z()));
}

void append(TriangleMesh& to, const TriangleMesh& from, const Eigen::Isometry3d& T) {
  const auto vertices = static_cast<std::uint32_t>(to.vertices.size());
  const auto objects = static_cast<std::uint32_t>(to.objects.size());
  for (const Eigen::Vector3f& p : from.vertices) {
    to.vertices.emplace_back((T * p.cast<double>()).cast<float>());
  }
  for (const auto& [a, b, c] : from.triangles) {
    to.triangles.push_back({a + vertices, b + vertices, c + vertices});
  }
  for (const std::uint32_t object : from.object) to.object.push_back(object + objects);
  to.objects.insert(to.objects.end(), from.objects.begin(), from.objects.end());
}

// Boxes around the things people would name; the first few of each kind.
std::vector<Landmark> name_landmarks(const TriangleMesh& mesh) {
  constexpr std::array<std::string_view, 10> kNamed = {"reception desk",
                                                       "stairs",
                                                       "mezzanine",
                                                       "air vent",
                                                       "altar",
                                                       "statue",
                                                       "vending machine",
                                                       "stair core",
                                                       "cabin",
                                                       "table"};
  constexpr int kOfEach = 3;
  std::vector<Eigen::AlignedBox3d> boxes(mesh.objects.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i]) {
      boxes[mesh.object[i]].extend(mesh.vertices[corner].cast<double>());
    }
  }
  std::map<std::string, int> seen;
  std::vector<Landmark> landmarks;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    std::string name = mesh.objects[i].name;
    if (std::find(kNamed.begin(), kNamed.end(), name) == kNamed.end()) continue;
    const int number = ++seen[name];
    if (number > kOfEach || boxes[i].isEmpty()) continue;
    std::replace(name.begin(), name.end(), ' ', '-');
    landmarks.push_back({name + "-" + std::to_string(number), boxes[i].min(), boxes[i].max()});
  }
  return landmarks;
}

}  // namespace

std::span<const PlaceType> all_place_types() {
  static constexpr std::array<PlaceType, 6> kAll = {PlaceType::kLobby,
                                                    PlaceType::kTemple,
                                                    PlaceType::kOffice,
                                                    PlaceType::kCorridor,
                                                    PlaceType::kHall,
                                                    PlaceType::kStorage};
  return kAll;
}

std::string_view place_type_name(PlaceType type) { return entry(type).name; }
std::string_view place_type_summary(PlaceType type) { return entry(type).summary; }

PlaceType place_type_from_name(std::string_view name) {
  std::string names;
  for (const TypeEntry& known : kTypes) {
    if (known.name == name) return known.type;
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  throw Error(ErrorCode::kInvalidArgument,
              "no type of place is called '" + std::string(name) + "'; there are " + names);
}

Place make_place(const PlaceOptions& options) {
  check(options);
  Place place;
  place.options = options;
  if (options.floors == 0) place.options.floors = entry(options.type).floors;
  if (options.stations == 0) place.options.stations = entry(options.type).stations;
  place.name = name_of(options);
  Random pose(stream(options.seed, 5, options.twin, 0));
  const Eigen::Isometry3d T_scene_building =
      at(pose.uniform(-3.0, 3.0), pose.uniform(-3.0, 3.0), 0.0, pose.uniform(-3.1, 3.1));
  for (int floor = 0; floor < place.options.floors; ++floor) {
    Storey storey = make_storey(place.options, floor);
    if (floor > 0 && options.copies == FloorCopies::kOneDifference) add_difference(storey, floor);
    place.floor_height_m = storey.height_m + kSlab_m;
    const Eigen::Isometry3d T = T_scene_building * at(0.0, 0.0, floor * place.floor_height_m);
    append(place.mesh, storey.mesh, T);
    for (StandingArea area : storey.areas) {
      area.T_scene_area = T * area.T_scene_area;
      area.floor = floor;
      place.areas.push_back(area);
    }
  }
  place.landmarks = name_landmarks(place.mesh);
  place.caster = std::make_shared<RayCaster>(place.mesh);
  place.stations = choose_stations(place);
  return place;
}

}  // namespace landmarkdb::datasets
