#include "engine/cloud/cloud_merger.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/cloud/cloud_builder.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kBetweenChecks = std::size_t{1} << 16U;
constexpr std::size_t kMostViewpoints = std::numeric_limits<std::uint16_t>::max();

Eigen::Vector3f carry(const Eigen::Matrix3d& R,
                      const Eigen::Vector3d& t,
                      const Eigen::Vector3f& p) {
  return (R * p.cast<double>() + t).cast<float>();
}

}  // namespace

void CloudMerger::begin_scan(const Eigen::Isometry3d& T_scene_cloud) {
  T_scene_cloud_ = T_scene_cloud;
  scan_is_new_ = true;
}

void CloudMerger::reserve(std::size_t points) {
  merged_.points.reserve(points);
  if (!merged_.normals.empty()) merged_.normals.reserve(points);
  if (!merged_.colours.empty()) merged_.colours.reserve(points);
  if (!merged_.viewpoint_index.empty()) merged_.viewpoint_index.reserve(points);
  if (!merged_.weights.empty()) merged_.weights.reserve(points);
}

void CloudMerger::append(const PointCloud& block, const RunContext& context) {
  if (block.empty()) return;
  choose_what_to_keep(block);
  const Eigen::Matrix3d R = T_scene_cloud_.linear();
  if (merged_.empty()) {
    // Zero when float keeps the points there. All scans of one place are near each other.
    const Eigen::Vector3f& middle = block.points[block.size() / 2];
    merged_.origin =
        round_origin(T_scene_cloud_ * Eigen::Vector3d(block.origin + middle.cast<double>()));
  }
  const Eigen::Vector3d t = T_scene_cloud_ * block.origin - merged_.origin;
  if (keeps_viewpoints() && scan_is_new_) add_viewpoints(block, t);
  // All blocks of the scan have its viewpoints, which were added last.
  const std::size_t first_viewpoint =
      keeps_viewpoints() ? merged_.viewpoints.size() - block.viewpoints.size() : 0;
  for (std::size_t i = 0; i < block.size(); ++i) {
    if (i % kBetweenChecks == 0) context.check("preprocess");
    merged_.points.push_back(carry(R, t, block.points[i]));
    if (normals_) merged_.normals.push_back((R * block.normals[i].cast<double>()).cast<float>());
    if (colours_) merged_.colours.push_back(block.colours[i]);
    if (keeps_viewpoints()) {
      const std::size_t own = block.viewpoint_index.empty() ? 0 : block.viewpoint_index[i];
      merged_.viewpoint_index.push_back(static_cast<std::uint16_t>(first_viewpoint + own));
    }
  }
  if (!merged_.weights.empty()) merged_.weights.resize(merged_.size(), 1);
  scan_is_new_ = false;
}

void CloudMerger::choose_what_to_keep(const PointCloud& block) {
  normals_ = normals_ && block.normals.size() == block.size();
  colours_ = colours_ && block.colours.size() == block.size();
  all_have_viewpoints_ = all_have_viewpoints_ && !block.viewpoints.empty();
  if (scan_is_new_) viewpoint_count_ += block.viewpoints.size();
  if (!normals_) merged_.normals = {};
  if (!colours_) merged_.colours = {};
  if (!keeps_viewpoints()) {
    merged_.viewpoints = {};
    merged_.viewpoint_index = {};
  }
}

bool CloudMerger::keeps_viewpoints() const {
  return all_have_viewpoints_ && viewpoint_count_ <= kMostViewpoints;
}

void CloudMerger::add_viewpoints(const PointCloud& block, const Eigen::Vector3d& t) {
  for (const Eigen::Vector3f& viewpoint : block.viewpoints) {
    merged_.viewpoints.push_back(carry(T_scene_cloud_.linear(), t, viewpoint));
  }
}

PointCloud CloudMerger::finish() {
  if (all_have_viewpoints_ && viewpoint_count_ > kMostViewpoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "the clouds have " + std::to_string(viewpoint_count_) +
                    " viewpoints, want at most " + std::to_string(kMostViewpoints));
  }
  if (merged_.viewpoints.size() <= 1) merged_.viewpoint_index.clear();
  PointCloud merged = std::exchange(merged_, {});
  *this = {};
  return merged;
}

}  // namespace landmarkdb
