#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

inline constexpr std::size_t kShotLength = 352;  // 32 spatial sectors x 11 bins (Tombari 2010)

enum class KeypointMethod { kUniform, kStructure, kIss, kNarf };

// How an entry is described. Derived from the entry's own extent and density when it is indexed,
// stored with it, and used for the queries that are matched against it.
struct FeatureOptions {
  double voxel_m = 0.0;  // working resolution; thinning, and the unit of all that follows
  double normal_radius_m = 0.0;
  double shot_radius_m = 0.0;  // support of descriptor and local reference frame
  double keypoint_spacing_m = 0.0;
  KeypointMethod keypoints = KeypointMethod::kStructure;
  bool operator==(const FeatureOptions&) const = default;
};

// Chosen points of a prepared cloud. `index[i]` is the point's place in it.
struct Keypoints {
  std::vector<std::uint32_t> index;
  std::size_t size() const { return index.size(); }
};

// N keypoints with their descriptors and local reference frames; rows whose frame is not defined
// were dropped and counted.
struct DescriptorSet {
  std::vector<Eigen::Vector3f> keypoints;  // N positions, frame of the cloud
  std::vector<Eigen::Vector3f> normals;    // N unit normals
  std::vector<Eigen::Matrix3f>
      frames;                 // N rotations R_cloud_lrf: columns are the frame's x, y, z axes
  std::vector<float> values;  // N x kShotLength, row-major, unit L2 length
  std::size_t dropped = 0;

  std::size_t size() const { return keypoints.size(); }
  std::span<const float> row(std::size_t i) const {
    return std::span<const float>(values).subspan(i * kShotLength, kShotLength);
  }
};

}  // namespace landmarkdb
