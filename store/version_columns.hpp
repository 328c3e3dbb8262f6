#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "store/manifest.hpp"
#include "store/sqlite.hpp"

namespace landmarkdb {

// The columns of scene_version that repeat the manifest, for listings and for people: derived, so
// `repair` can write them anew.
struct VersionColumns {
  std::string kind;
  std::int64_t points = 0;
  std::int64_t keypoints = 0;
  FeatureOptions options;
  std::optional<Eigen::Vector3d> up;
  std::string sources;   // JSON
  std::string warnings;  // JSON
  bool operator==(const VersionColumns&) const = default;
};

VersionColumns columns_of(const Manifest& manifest);

// Within the caller's transaction; the row must exist.
VersionColumns read_version_columns(const sqlite::Database& database,
                                    std::int64_t scene_id,
                                    std::int64_t version);
void write_version_columns(const sqlite::Database& database,
                           std::int64_t scene_id,
                           std::int64_t version,
                           const VersionColumns& columns);

}  // namespace landmarkdb
