#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb::bench {

// Another way to find where a frame was taken in one place.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual std::string name() const = 0;

  // Once a place: all that does not depend on the frame. Scene frame, viewpoints known.
  virtual void prepare(const PointCloud& place) = 0;

  // T_scene_sensor of a frame (sensor frame, viewpoint at zero); nothing where it gives up.
  virtual std::optional<Eigen::Isometry3d> find(const PointCloud& query) = 0;
};

// The points of a cloud by the viewpoint they were seen from: normals are turned one station at a
// time, as these libraries know one viewpoint a cloud.
struct Station {
  Eigen::Vector3f viewpoint = Eigen::Vector3f::Zero();
  std::vector<Eigen::Vector3f> points;
};
std::vector<Station> stations_of(const PointCloud& cloud);

// What both are run with: the lengths the engine itself takes for rooms of this size, but for the
// descriptor's radius, which is the one that PCL's pipeline did best with.
struct PeerLengths {
  double voxel_m = 0.05;
  double normal_radius_m = 0.125;
  double keypoint_spacing_m = 0.15;
  double descriptor_radius_m = 0.5;
  double inlier_m = 0.15;
};

// SHOT, mutual nearest neighbours, random samples, ICP, all by PCL; empty where the library's
// registration part is not installed.
std::vector<std::unique_ptr<Peer>> pcl_peers(int threads);

// FPFH with random samples and with fast global registration (Zhou, Park, Koltun 2016), then point
// to plane ICP, by Open3D; empty where it is not installed.
std::vector<std::unique_ptr<Peer>> open3d_peers();

}  // namespace landmarkdb::bench
