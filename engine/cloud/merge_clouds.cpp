#include "engine/cloud/merge_clouds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "engine/base/error.hpp"
#include "engine/cloud/cloud_builder.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kBetweenChecks = std::size_t{1} << 16U;
constexpr std::size_t kMostViewpoints = std::numeric_limits<std::uint16_t>::max();

struct Kept {
  bool normals = true, colours = true, viewpoints = true;
  std::size_t points = 0, viewpoint_count = 0;
};

Kept what_all_have(std::span<const PointCloud> clouds) {
  Kept kept;
  for (const PointCloud& cloud : clouds) {
    if (cloud.empty()) continue;
    kept.normals = kept.normals && cloud.normals.size() == cloud.size();
    kept.colours = kept.colours && cloud.colours.size() == cloud.size();
    kept.viewpoints = kept.viewpoints && !cloud.viewpoints.empty();
    kept.points += cloud.size();
    kept.viewpoint_count += cloud.viewpoints.size();
  }
  return kept;
}

// Where the merged points lie, in the scene frame: zero when float keeps them there, else the first
// origin that is far out. All clouds of one place are near each other.
Eigen::Vector3d choose_origin(std::span<const PointCloud> clouds,
                              std::span<const Eigen::Isometry3d> T_scene_cloud) {
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    if (clouds[c].empty()) continue;
    const std::size_t middle = clouds[c].size() / 2;
    const Eigen::Vector3d p =
        T_scene_cloud[c] *
        Eigen::Vector3d(clouds[c].origin + clouds[c].points[middle].cast<double>());
    return round_origin(p);
  }
  return Eigen::Vector3d::Zero();
}

}  // namespace

PointCloud merge_clouds(std::span<const PointCloud> clouds,
                        std::span<const Eigen::Isometry3d> T_scene_cloud,
                        const RunContext& context) {
  if (clouds.size() != T_scene_cloud.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(clouds.size()) + " clouds come with " +
                    std::to_string(T_scene_cloud.size()) + " poses, want one each");
  }
  const Kept kept = what_all_have(clouds);
  if (kept.viewpoints && kept.viewpoint_count > kMostViewpoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "the clouds have " + std::to_string(kept.viewpoint_count) +
                    " viewpoints, want at most " + std::to_string(kMostViewpoints));
  }
  PointCloud merged;
  merged.origin = choose_origin(clouds, T_scene_cloud);
  merged.points.reserve(kept.points);
  for (std::size_t c = 0; c < clouds.size(); ++c) {
    const PointCloud& cloud = clouds[c];
    if (cloud.empty()) continue;
    const Eigen::Matrix3d R = T_scene_cloud[c].linear();
    const Eigen::Vector3d t = T_scene_cloud[c] * cloud.origin - merged.origin;
    auto carry = [&](const Eigen::Vector3f& p) {
      return Eigen::Vector3f((R * p.cast<double>() + t).cast<float>());
    };
    const std::size_t first_viewpoint = merged.viewpoints.size();
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (i % kBetweenChecks == 0) context.check("preprocess");
      merged.points.push_back(carry(cloud.points[i]));
      if (kept.normals) {
        merged.normals.push_back((R * cloud.normals[i].cast<double>()).cast<float>());
      }
      if (kept.colours) merged.colours.push_back(cloud.colours[i]);
      if (kept.viewpoints) {
        const std::size_t own = cloud.viewpoint_index.empty() ? 0 : cloud.viewpoint_index[i];
        merged.viewpoint_index.push_back(static_cast<std::uint16_t>(first_viewpoint + own));
      }
    }
    if (!kept.viewpoints) continue;
    for (const Eigen::Vector3f& viewpoint : cloud.viewpoints) {
      merged.viewpoints.push_back(carry(viewpoint));
    }
  }
  if (merged.viewpoints.size() <= 1) merged.viewpoint_index.clear();
  return merged;
}

}  // namespace landmarkdb
