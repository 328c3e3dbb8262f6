#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::datasets {

enum class QuerySensor { kDepthCamera, kLidar };

struct SetOptions {
  ScannerOptions scanner;
  std::size_t queries = 10;
  std::size_t query_points = 0;  // exactly so many of each query's points; 0: all
  QuerySensor sensor = QuerySensor::kDepthCamera;
  DepthCameraOptions camera;
  LidarOptions lidar;
  PoseSampling sampling;
  bool organised = false;  // depth frames as PCD, width x height, NaN where there is no depth
  std::uint64_t seed = 1;  // of poses and noise
};

// What write_place_set wrote.
struct PlaceSet {
  std::string name;
  std::size_t points = 0;  // of all stations
  std::size_t queries = 0;
  std::size_t informative = 0;  // of the queries: see DepthFrame::normal_spread
  std::string index_command;    // to be run in the folder
};

// Writes the place as a folder of files, which is made if need be:
//
//   manifest.json             what is in the folder, all truths, the command that indexes it
//   station-00.ply, .pose.txt one cloud a station in its own frame; T_scene_station, 16 numbers
//   query-000.ply, .truth.json  one cloud a query in the sensor frame; T_scene_sensor, up
//
// The manifest is written last. Throws Error of the writers, and of scan_place and
// sample_camera_poses.
PlaceSet write_place_set(const Place& place,
                         const std::filesystem::path& folder,
                         const SetOptions& options,
                         const RunContext& context);

// The clouds of a folder written above as one, scene frame. Throws Error{kInvalidArgument} when the
// folder has no manifest that can be read.
PointCloud read_place_set(const std::filesystem::path& folder);

}  // namespace landmarkdb::datasets
