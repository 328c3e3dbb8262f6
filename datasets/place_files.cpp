#include "datasets/place_files.hpp"

#include <array>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <optional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "datasets/subsample.hpp"
#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/cloud/merge_clouds.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/cloud/write_cloud.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::datasets {
namespace {

using nlohmann::ordered_json;

// Frames whose normals spread less slide along a wall or turn about an axis.
constexpr double kInformativeSpread = 0.03;

std::string numbered(const std::string& stem, std::size_t number, int digits) {
  std::ostringstream out;
  out << stem << '-' << std::setfill('0') << std::setw(digits) << number;
  return out.str();
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw Error(ErrorCode::kResourceExhausted, path.string() + ": cannot be written");
}

std::string pose_text(const Eigen::Isometry3d& T) {
  std::string text;
  for (int row = 0; row < 4; ++row) {
    std::array<char, 128> line{};
    std::snprintf(line.data(),
                  line.size(),
                  "%.17g %.17g %.17g %.17g\n",
                  T(row, 0),
                  T(row, 1),
                  T(row, 2),
                  T(row, 3));
    text += line.data();
  }
  return text;
}

ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
ordered_json pose_json(const Eigen::Isometry3d& T) { return to_row_major(T.matrix()); }

ordered_json options_json(const Place& place) {
  constexpr std::array<const char*, 3> kCopies = {"look-alike", "one-difference", "exact"};
  const PlaceOptions& options = place.options;
  return {{"type", place_type_name(options.type)},
          {"seed", options.seed},
          {"size", options.size},
          {"clutter", options.clutter},
          {"floors", options.floors},
          {"copies", kCopies[static_cast<std::size_t>(options.copies)]},
          {"day", options.day},
          {"twin", options.twin},
          {"stations_per_floor", options.stations}};
}

ordered_json write_stations(const Place& place,
                            const std::filesystem::path& folder,
                            const ScannerOptions& options,
                            const RunContext& context,
                            PlaceSet& set) {
  ordered_json stations = ordered_json::array();
  set.index_command = "landmarkdb-indexer --db places.db add " + set.name;
  std::string poses;
  const std::vector<StationScan> scans = scan_place(place, options, context);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    context.report("write", i, scans.size());
    const std::string stem = numbered("station", i, 2);
    write_cloud(folder / (stem + ".ply"), scans[i].cloud);
    write_text(folder / (stem + ".pose.txt"), pose_text(scans[i].T_scene_station));
    set.points += scans[i].cloud.size();
    set.index_command += " " + stem + ".ply";
    poses += " --pose " + stem + ".pose.txt --viewpoint 0,0,0";
    stations.push_back({{"cloud", stem + ".ply"},
                        {"pose", stem + ".pose.txt"},
                        {"points", scans[i].cloud.size()},
                        {"T_scene_station", pose_json(scans[i].T_scene_station)}});
  }
  set.index_command += poses + " --up 0,0,1";
  return stations;
}

struct Query {
  PointCloud cloud;
  std::optional<double> normal_spread;
};

// Nothing where the sensor sees fewer points than are wanted.
std::optional<Query> take_query(const Place& place,
                                const Eigen::Isometry3d& T_scene_sensor,
                                const SetOptions& options,
                                std::uint64_t seed,
                                const RunContext& context) {
  if (options.sensor == QuerySensor::kLidar) {
    LidarOptions lidar = options.lidar;
    lidar.seed = seed;
    const PointCloud turn = render_lidar(place, T_scene_sensor, lidar, context);
    if (turn.size() < options.query_points) return std::nullopt;
    return Query{subsample(turn, options.query_points, seed), std::nullopt};
  }
  DepthCameraOptions camera = options.camera;
  camera.seed = seed;
  DepthFrame frame = render_depth(place, T_scene_sensor, camera, context);
  if (frame.valid < options.query_points) return std::nullopt;
  if (options.organised) return Query{std::move(frame.cloud), frame.normal_spread};
  return Query{subsample(frame.cloud, options.query_points, seed), frame.normal_spread};
}

ordered_json write_query(const Place& place,
                         const std::filesystem::path& folder,
                         const Eigen::Isometry3d& T_scene_sensor,
                         const Query& query,
                         const std::string& file,
                         const std::string& stem) {
  const Eigen::Vector3d up_sensor = T_scene_sensor.linear().transpose() * place.up;
  ordered_json truth = {{"scene", place.name},
                        {"cloud", file},
                        {"points", query.cloud.size()},
                        {"T_scene_sensor", pose_json(T_scene_sensor)},
                        {"up_sensor", vector_json(up_sensor)}};
  if (query.normal_spread) {
    truth["normal_spread"] = *query.normal_spread;
    truth["informative"] = *query.normal_spread >= kInformativeSpread;
  }
  write_cloud(folder / file, query.cloud);
  write_text(folder / (stem + ".truth.json"), truth.dump(1) + "\n");
  write_text(folder / (stem + ".pose.txt"), pose_text(T_scene_sensor));
  return truth;
}

ordered_json write_queries(const Place& place,
                           const std::filesystem::path& folder,
                           const SetOptions& options,
                           const RunContext& context,
                           PlaceSet& set) {
  const bool camera = options.sensor == QuerySensor::kDepthCamera;
  // Poses that see too few points for the size wanted are passed over.
  const std::size_t drawn = options.queries + options.queries / 2 + 4;
  const std::vector<Eigen::Isometry3d> poses =
      camera ? sample_camera_poses(place, drawn, options.seed, options.sampling)
             : sample_upright_poses(place, drawn, options.seed, options.sampling);
  ordered_json queries = ordered_json::array();
  for (std::size_t i = 0; i < poses.size() && queries.size() < options.queries; ++i) {
    context.report("queries", queries.size(), options.queries);
    const std::optional<Query> query =
        take_query(place, poses[i], options, Random(options.seed * 7919 + i).next(), context);
    if (!query) continue;
    const std::string stem = numbered("query", queries.size(), 3);
    const std::string file = stem + (options.organised && camera ? ".pcd" : ".ply");
    queries.push_back(write_query(place, folder, poses[i], *query, file, stem));
    if (query->normal_spread.value_or(0.0) >= kInformativeSpread) ++set.informative;
  }
  set.queries = queries.size();
  if (set.queries < options.queries) {
    throw Error(ErrorCode::kInvalidArgument,
                place.name + ": only " + std::to_string(set.queries) + " of " +
                    std::to_string(poses.size()) + " free poses see " +
                    std::to_string(options.query_points) + " points, want " +
                    std::to_string(options.queries));
  }
  return queries;
}

ordered_json landmarks_json(const Place& place) {
  ordered_json landmarks = ordered_json::array();
  for (const Landmark& landmark : place.landmarks) {
    landmarks.push_back({{"name", landmark.name},
                         {"min_m", vector_json(landmark.min_m)},
                         {"max_m", vector_json(landmark.max_m)}});
  }
  return landmarks;
}

}  // namespace

PlaceSet write_place_set(const Place& place,
                         const std::filesystem::path& folder,
                         const SetOptions& options,
                         const RunContext& context) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) {
    throw Error(ErrorCode::kInvalidArgument,
                folder.string() + ": no folder can be made there: " + failure.message());
  }
  PlaceSet set;
  set.name = place.name;
  const ordered_json stations = write_stations(place, folder, options.scanner, context, set);
  const ordered_json queries = write_queries(place, folder, options, context, set);
  const ordered_json manifest = {{"name", place.name},
                                 {"licence", "CC0-1.0"},
                                 {"units", "m"},
                                 {"up", vector_json(place.up)},
                                 {"place", options_json(place)},
                                 {"scanner_seed", options.scanner.seed},
                                 {"query_seed", options.seed},
                                 {"points", set.points},
                                 {"index_command", set.index_command},
                                 {"stations", stations},
                                 {"queries", queries},
                                 {"landmarks", landmarks_json(place)}};
  write_text(folder / "manifest.json", manifest.dump(1) + "\n");
  return set;
}

PointCloud read_place_set(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "manifest.json";
  std::vector<PointCloud> clouds;
  std::vector<Eigen::Isometry3d> poses;
  try {
    std::ifstream in(path);
    const nlohmann::json manifest = nlohmann::json::parse(in);
    for (const auto& station : manifest.at("stations")) {
      const auto numbers = station.at("T_scene_station").get<std::array<double, 16>>();
      poses.push_back(from_row_major(numbers));
      clouds.push_back(read_cloud(folder / station.at("cloud").get<std::string>(), {}));
    }
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorCode::kInvalidArgument,
                path.string() + ": no manifest of a generated place: " + error.what());
  }
  return merge_clouds(clouds, poses);
}

}  // namespace landmarkdb::datasets
