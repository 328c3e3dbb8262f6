#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::client {

// One stored version of a scene. Times are ISO 8601, UTC.
struct SceneVersion {
  std::int64_t version = 0;
  std::string created;
  bool active = false;
  std::uint64_t points = 0, keypoints = 0, bytes = 0;
  std::string retired;  // empty while active
  std::string damage;   // what is wrong with it, where a check found something
};

// A scene as the server lists it. Lengths in metres, scene frame.
struct SceneInfo {
  std::string name;
  std::int64_t scene_id = 0;
  std::int64_t version = 0;  // the active one
  EntryKind kind = EntryKind::kPlace;
  bool quarantined = false;  // damaged; the others are served without it
  std::string state_reason;  // why, for a quarantined one
  std::uint64_t points = 0, keypoints = 0;
  std::uint64_t bytes = 0;  // of all versions
  std::string created;      // when the scene was first added
  FeatureOptions options;
  std::map<std::string, std::string> tags;
  std::vector<Landmark> landmarks;
  std::vector<std::string> sources;
  std::vector<std::string> warnings;
  std::optional<Eigen::Vector3d> up;
  // Bounds of the points; only of Client::scene(), and not of a quarantined one.
  std::optional<Eigen::Vector3d> min_m;
  std::optional<Eigen::Vector3d> max_m;
  std::vector<SceneVersion> versions;  // only of Client::scene()
};

// A scan to be stored: metres, its pose in the scene frame, its file's name for the record.
struct SceneScan {
  PointCloud cloud;
  Eigen::Isometry3d T_scene_cloud = Eigen::Isometry3d::Identity();
  std::string source;
};

// What is left out is derived from the data by the server.
struct SceneAdd {
  std::string name;
  std::vector<SceneScan> scans;
  EntryKind kind = EntryKind::kPlace;
  std::optional<double> voxel_m;
  std::optional<double> radius_m;
  std::optional<KeypointMethod> keypoints;
  std::optional<Eigen::Vector3d> up;
};

struct Stats {
  std::string server_version;
  double uptime_s = 0.0;
  std::uint64_t generation = 0, scenes = 0, quarantined = 0, points = 0, keypoints = 0;
  std::uint64_t connections = 0, connections_total = 0, requests_total = 0, errors_total = 0;
  std::uint64_t queries_localized = 0, queries_ambiguous = 0, queries_not_found = 0;
  std::uint64_t in_flight = 0, queued = 0, rejected_total = 0, threads = 0;
  double query_ms_mean = 0.0, query_ms_max = 0.0;
  std::uint64_t models = 0, recognized = 0, recognize_not_found = 0;
  double recognize_ms_mean = 0.0, recognize_ms_max = 0.0;
  std::uint64_t tracks_open = 0, track_frames = 0, track_frames_seen = 0;
  double track_ms_mean = 0.0, track_ms_max = 0.0;
  std::uint64_t resident_bytes = 0, database_bytes = 0, reloads_total = 0;
  std::uint64_t scenes_on_demand = 0, scene_memory_bytes = 0, scene_loads = 0;
};

struct Health {
  std::string status;  // "ok", "starting", "degraded", "stopping" or "failed"
  bool ready = false;  // queries are answered
  std::vector<std::string> problems;
  std::vector<std::string> quarantined;  // scenes
};

struct Reload {
  std::uint64_t generation = 0, scenes = 0, quarantined = 0;
};

}  // namespace landmarkdb::client
