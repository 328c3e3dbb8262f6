#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "store/store_types.hpp"

namespace landmarkdb::indexer {

// A place or object to be indexed. Each of `poses` and `viewpoints` is empty or as long as
// `clouds`.
struct AddRequest {
  std::string name;
  std::vector<std::string> clouds;
  std::vector<Eigen::Isometry3d> poses;     // T_scene_cloud; empty: identity
  std::vector<Eigen::Vector3d> viewpoints;  // metres, each in its cloud's own frame
  Units units = Units::kMetres;             // of the files
  IndexOptions options;
};

struct AddResult {
  InsertResult stored;
  SceneRecord record;  // as stored
};

// Reads the clouds, turned to metres, each with its pose and viewpoint, into one of the scene; of
// many points no more are in memory than ScanGatherer holds. Reports the stages "read" in bytes of
// all files together, and "sanitise".
GatheredScans gather_scans(const AddRequest& request, const RunContext& context);

// Reads, describes and stores. The database is opened for writing only at the end, and made where
// there is none; whatever goes wrong before leaves it as it was.
AddResult add_scene(const AddRequest& request, const std::string& db, const RunContext& context);

}  // namespace landmarkdb::indexer
