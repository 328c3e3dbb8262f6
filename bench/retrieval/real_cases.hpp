#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace landmarkdb::bench {

// One question of the real data: a query cloud and where it was taken. No target: it is nowhere.
struct RealCase {
  std::string id;
  std::string kind;  // "scene" or "object"
  std::filesystem::path query;
  std::vector<std::filesystem::path> targets;
  std::vector<std::filesystem::path>
      database;  // a list of its own, or empty: all entries of the kind
  std::optional<Eigen::Isometry3d> T_target_query;
  double accuracy_m = 0.0;
  double accuracy_rad = 0.0;
};

struct RealData {
  std::vector<RealCase> cases;
  std::vector<std::filesystem::path> places;
  std::vector<std::filesystem::path> objects;
};

// Reads database.json and cases.json of the folder. Throws Error{kInvalidArgument}.
RealData read_real_data(const std::filesystem::path& folder);

}  // namespace landmarkdb::bench
