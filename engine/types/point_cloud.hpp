#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// Points as a sensor or file gave them, in metres.
//
// `origin` (double) + `points[i]` (float) is the position in the cloud's own frame: a georeferenced
// scan keeps its millimetres because the points stay small. For every sensor cloud the origin is
// zero. Arrays other than `points` are empty or as long as `points`.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;              // unit length
  std::vector<std::array<std::uint8_t, 3>> colours;  // red, green, blue
  // How many measured points each is the mean of, where a cloud was condensed. Empty: one each.
  std::vector<std::uint32_t> weights;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();

  // Where the points were seen from (same frame as `points`, so without `origin`), and which of
  // these each point belongs to. No viewpoint: not known. `viewpoint_index` empty: all points
  // belong to the first.
  std::vector<Eigen::Vector3f> viewpoints;
  std::vector<std::uint16_t> viewpoint_index;

  // Organised clouds (depth cameras) are width x height, row-major, invalid pixels NaN; 0 x 0
  // otherwise.
  std::uint32_t width = 0;
  std::uint32_t height = 0;

  std::size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
};

// What the sanitiser took out of a cloud.
struct CloudCounts {
  std::size_t points = 0;        // as given
  std::size_t not_finite = 0;    // NaN or infinite, dropped
  std::size_t duplicates = 0;    // same position as an earlier one, dropped
  std::size_t out_of_range = 0;  // further off than any scan reaches, or far off and alone
  std::size_t used = 0;          // what was left

  std::size_t invalid() const { return points - used; }
};

// A cloud at a working resolution: one point a voxel, each with a unit normal. What every later
// stage reads.
struct PreparedCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  // as many as points
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3f> viewpoints;
  std::vector<std::uint16_t> viewpoint_index;  // empty or as many as points
  double resolution_m = 0.0;                   // voxel size
  bool normals_from_viewpoint = false;         // false: orientation is only consistent, not known
  CloudCounts counts;

  std::size_t size() const { return points.size(); }
};

}  // namespace landmarkdb
