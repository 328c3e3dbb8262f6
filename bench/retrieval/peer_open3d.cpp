#include <open3d/geometry/KDTreeSearchParam.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/pipelines/registration/CorrespondenceChecker.h>
#include <open3d/pipelines/registration/FastGlobalRegistration.h>
#include <open3d/pipelines/registration/Feature.h>
#include <open3d/pipelines/registration/Registration.h>
#include <open3d/pipelines/registration/TransformationEstimation.h>

#include "bench/retrieval/peer.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {

namespace {

namespace registration = open3d::pipelines::registration;
using open3d::geometry::KDTreeSearchParamHybrid;
using open3d::geometry::KDTreeSearchParamRadius;
using Cloud = open3d::geometry::PointCloud;

// FPFH at every point of 10 cm voxels, radius five times that: the proportions of Open3D's own
// tutorial on global registration.
constexpr double kVoxel_m = 0.10;
constexpr double kRadius_m = 0.5;
constexpr int kMostNeighbours = 100;  // the tutorial's

struct Described {
  std::shared_ptr<Cloud> cloud;
  std::shared_ptr<registration::Feature> features;
};

Described describe(const PointCloud& points, const PeerLengths& lengths) {
  Cloud all;
  for (const Station& station : stations_of(points)) {
    if (station.points.empty()) continue;
    Cloud raw;
    for (const Eigen::Vector3f& p : station.points) raw.points_.push_back(p.cast<double>());
    const auto thinned = raw.VoxelDownSample(lengths.voxel_m);
    thinned->EstimateNormals(KDTreeSearchParamRadius(lengths.normal_radius_m));
    thinned->OrientNormalsTowardsCameraLocation(station.viewpoint.cast<double>());
    all += *thinned;
  }
  Described described;
  described.cloud = all.VoxelDownSample(kVoxel_m);
  described.cloud->NormalizeNormals();
  described.features = registration::ComputeFPFHFeature(
      *described.cloud, KDTreeSearchParamHybrid(kRadius_m, kMostNeighbours));
  return described;
}

class Open3dPeer : public Peer {
 public:
  explicit Open3dPeer(bool fast) : fast_(fast) {}

  std::string name() const override {
    return fast_ ? "Open3D: FPFH, fast global, ICP" : "Open3D: FPFH, RANSAC, ICP";
  }

  void prepare(const PointCloud& place) override { place_ = describe(place, lengths_); }

  std::optional<Eigen::Isometry3d> find(const PointCloud& query) override {
    const Described seen = describe(query, lengths_);
    if (seen.cloud->points_.size() < 3) return std::nullopt;
    const Eigen::Matrix4d start = fast_ ? fast_global(seen) : by_samples(seen);
    const auto refined =
        registration::RegistrationICP(*seen.cloud,
                                      *place_.cloud,
                                      2.0 * lengths_.inlier_m,
                                      start,
                                      registration::TransformationEstimationPointToPlane(),
                                      registration::ICPConvergenceCriteria(1e-6, 1e-6, 50));
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = nearest_rotation(refined.transformation_.topLeftCorner<3, 3>());
    T.translation() = refined.transformation_.topRightCorner<3, 1>();
    return T;
  }

 private:
  Eigen::Matrix4d by_samples(const Described& seen) const {
    const registration::CorrespondenceCheckerBasedOnEdgeLength edges(0.9);
    const registration::CorrespondenceCheckerBasedOnDistance distance(lengths_.inlier_m);
    return registration::RegistrationRANSACBasedOnFeatureMatching(
               *seen.cloud,
               *place_.cloud,
               *seen.features,
               *place_.features,
               true,
               lengths_.inlier_m,
               registration::TransformationEstimationPointToPoint(false),
               3,
               {edges, distance},
               registration::RANSACConvergenceCriteria(100'000, 0.999))
        .transformation_;
  }

  Eigen::Matrix4d fast_global(const Described& seen) const {
    registration::FastGlobalRegistrationOption options;
    options.maximum_correspondence_distance_ = lengths_.inlier_m;
    options.use_absolute_scale_ = true;
    return registration::FastGlobalRegistrationBasedOnFeatureMatching(
               *seen.cloud, *place_.cloud, *seen.features, *place_.features, options)
        .transformation_;
  }

  bool fast_;
  PeerLengths lengths_;
  Described place_;
};

}  // namespace

std::vector<std::unique_ptr<Peer>> open3d_peers() {
  std::vector<std::unique_ptr<Peer>> peers;
  peers.push_back(std::make_unique<Open3dPeer>(false));
  peers.push_back(std::make_unique<Open3dPeer>(true));
  return peers;
}

}  // namespace landmarkdb::bench
