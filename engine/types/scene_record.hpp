#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_source.hpp"

namespace landmarkdb {

// A place is seen in part by the query; an object stands whole somewhere in it.
enum class EntryKind { kPlace, kObject };

// A named part of a scene: an axis-aligned box in scene coordinates (metres, with the origin
// added).
struct Landmark {
  std::string name;
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
};

// One immutable version of a place or an object, as stored and as searched.
//
// Frames: `prepared` and `descriptors` hold float metres around `prepared.origin`; the scene frame
// is the frame of the first cloud's pose.
struct SceneRecord {
  std::string name;
  EntryKind kind = EntryKind::kPlace;
  FeatureOptions options;
  PreparedCloud prepared;
  DescriptorSet descriptors;
  std::optional<Eigen::Vector3d> up;  // unit, scene frame; where gravity is known
  std::vector<std::string> sources;   // file names as given, without folders
  std::vector<std::string> warnings;  // "units_suspect", "normals_unoriented", ...
};

// What the store knows beside the version's arrays.
struct CatalogEntry {
  std::int64_t scene_id = 0;
  std::int64_t version = 0;  // 1, 2, ... per scene
  std::map<std::string, std::string> tags;
  std::vector<Landmark> landmarks;
  // Where there is a `source`, an outline: no points, no keypoints, but all else.
  std::shared_ptr<const SceneRecord> record;
  std::string sha256{};  // of what the store holds of `record`; empty where it is not from a store
  std::uint64_t points = 0, keypoints = 0;      // of the whole record, where it is from a store
  std::shared_ptr<const SceneSource> source{};  // reads what the outline lacks; null: all is there
};

// All active entries at one moment. Never changes once built; shared between queries.
struct Catalog {
  std::uint64_t generation = 0;       // grows with every change of the database
  std::vector<CatalogEntry> entries;  // by scene_id, ascending
};

}  // namespace landmarkdb
