#pragma once

#include <cstddef>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Makes one cloud of scans of one place that come one after the other, or in blocks.
//
// The origin is chosen by the first points, so that the merged ones stay small. Colours are kept
// when all points have them, normals likewise; viewpoints are dropped unless all have one, and each
// point keeps that it was seen from. Empty clouds change nothing. Not thread-safe.
class CloudMerger {
 public:
  // What is appended next is of another scan; its pose carries it into the scene frame.
  void begin_scan(const Eigen::Isometry3d& T_scene_cloud);

  // A sanitised cloud, or a block of one: all blocks of a scan have its origin and viewpoints.
  // Throws what `context.check` does.
  void append(const PointCloud& block, const RunContext& context = {});

  void reserve(std::size_t points);

  // What there is so far, which may be condensed. Its points have viewpoint numbers wherever it has
  // viewpoints.
  const PointCloud& cloud() const { return merged_; }
  PointCloud& cloud() { return merged_; }

  // All of it; numbers are left out where there is one viewpoint only. Throws
  // Error{kInvalidArgument} when all points have viewpoints, and these are more than 16 bits count.
  // The merger is empty afterwards.
  PointCloud finish();

 private:
  void choose_what_to_keep(const PointCloud& block);
  void add_viewpoints(const PointCloud& block, const Eigen::Vector3d& t);
  bool keeps_viewpoints() const;

  PointCloud merged_;
  Eigen::Isometry3d T_scene_cloud_ = Eigen::Isometry3d::Identity();
  bool normals_ = true, colours_ = true;  // all points so far have them
  bool all_have_viewpoints_ = true;
  std::size_t viewpoint_count_ = 0;  // of all scans, kept or not
  bool scan_is_new_ = true;          // none of its viewpoints are there yet
};

}  // namespace landmarkdb
