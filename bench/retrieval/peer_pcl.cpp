#include <cmath>
#include <vector>

#include <pcl/correspondence.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/features/shot_omp.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_types.h>
#include <pcl/registration/correspondence_estimation.h>
#include <pcl/registration/correspondence_rejection_sample_consensus.h>
#include <pcl/registration/icp.h>

#include "bench/retrieval/peer.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::bench {

namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Oriented = pcl::PointCloud<pcl::PointNormal>;
using Shots = pcl::PointCloud<pcl::SHOT352>;

// A cloud as this pipeline knows it; `keypoints` and `shots` go together.
struct Described {
  Oriented::Ptr surface{new Oriented};
  Points::Ptr keypoints{new Points};
  Shots::Ptr shots{new Shots};
};

template <typename Point>
void thin(const typename pcl::PointCloud<Point>::ConstPtr& in,
          double edge_m,
          pcl::PointCloud<Point>& out) {
  pcl::VoxelGrid<Point> grid;
  const auto edge = static_cast<float>(edge_m);
  grid.setLeafSize(edge, edge, edge);
  grid.setInputCloud(in);
  grid.filter(out);
}

// One station thinned, with normals turned to its viewpoint.
Oriented::Ptr oriented(const Station& station, const PeerLengths& lengths, unsigned threads) {
  const Points::Ptr raw(new Points);
  for (const Eigen::Vector3f& p : station.points) raw->push_back({p.x(), p.y(), p.z()});
  const Points::Ptr thinned(new Points);
  thin<pcl::PointXYZ>(raw, lengths.voxel_m, *thinned);
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::PointNormal> normals(threads);
  normals.setInputCloud(thinned);
  normals.setRadiusSearch(lengths.normal_radius_m);
  normals.setViewPoint(station.viewpoint.x(), station.viewpoint.y(), station.viewpoint.z());
  Oriented::Ptr out(new Oriented);
  normals.compute(*out);
  for (std::size_t i = 0; i < out->size(); ++i) {
    (*out)[i].getVector3fMap() = (*thinned)[i].getVector3fMap();
  }
  std::erase_if(out->points,
                [](const pcl::PointNormal& p) { return !p.getNormalVector3fMap().allFinite(); });
  out->width = static_cast<std::uint32_t>(out->points.size());
  out->height = 1;
  return out;
}

Described describe(const PointCloud& cloud, const PeerLengths& lengths, unsigned threads) {
  const Oriented::Ptr all(new Oriented);
  for (const Station& station : stations_of(cloud)) {
    if (!station.points.empty()) *all += *oriented(station, lengths, threads);
  }
  Described described;
  thin<pcl::PointNormal>(all, lengths.voxel_m, *described.surface);
  for (pcl::PointNormal& p : *described.surface) {
    p.getNormalVector3fMap().normalize();  // a voxel's is the mean of its points'
  }
  const Oriented::Ptr spread(new Oriented);
  thin<pcl::PointNormal>(described.surface, lengths.keypoint_spacing_m, *spread);
  pcl::SHOTEstimationOMP<pcl::PointNormal, pcl::PointNormal, pcl::SHOT352> shot;
  shot.setNumberOfThreads(threads);
  shot.setInputCloud(spread);
  shot.setSearchSurface(described.surface);
  shot.setInputNormals(described.surface);
  shot.setRadiusSearch(lengths.descriptor_radius_m);
  Shots shots;
  shot.compute(shots);
  for (std::size_t i = 0; i < shots.size(); ++i) {
    if (!std::isfinite(shots[i].descriptor[0])) continue;
    described.keypoints->push_back({(*spread)[i].x, (*spread)[i].y, (*spread)[i].z});
    described.shots->push_back(shots[i]);
  }
  return described;
}

class PclPeer : public Peer {
 public:
  explicit PclPeer(int threads) : threads_(static_cast<unsigned>(threads)) {}

  std::string name() const override { return "PCL: SHOT, mutual, RANSAC, ICP"; }

  void prepare(const PointCloud& place) override {
    place_ = describe(place, lengths_, threads_);
    estimation_.setInputTarget(place_.shots);
    icp_.setInputTarget(place_.surface);
  }

  std::optional<Eigen::Isometry3d> find(const PointCloud& query) override {
    const Described seen = describe(query, lengths_, threads_);
    if (seen.shots->size() < 3) return std::nullopt;
    const pcl::CorrespondencesPtr mutual(new pcl::Correspondences);
    estimation_.setInputSource(seen.shots);
    estimation_.determineReciprocalCorrespondences(*mutual);

    constexpr int kIterations = 50'000;
    pcl::registration::CorrespondenceRejectorSampleConsensus<pcl::PointXYZ> ransac;
    ransac.setInputSource(seen.keypoints);
    ransac.setInputTarget(place_.keypoints);
    ransac.setInlierThreshold(lengths_.inlier_m);
    ransac.setMaximumIterations(kIterations);
    ransac.setInputCorrespondences(mutual);
    pcl::Correspondences inliers;
    ransac.getCorrespondences(inliers);
    if (inliers.size() < 3) return std::nullopt;

    icp_.setInputSource(seen.surface);
    icp_.setMaxCorrespondenceDistance(2.0 * lengths_.inlier_m);
    icp_.setMaximumIterations(50);
    Oriented moved;
    icp_.align(moved, ransac.getBestTransformation());
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const Eigen::Matrix4d found = icp_.getFinalTransformation().cast<double>();
    T.linear() = nearest_rotation(found.topLeftCorner<3, 3>());
    T.translation() = found.topRightCorner<3, 1>();
    return T;
  }

 private:
  unsigned threads_;
  PeerLengths lengths_;
  Described place_;
  pcl::registration::CorrespondenceEstimation<pcl::SHOT352, pcl::SHOT352> estimation_;
  pcl::IterativeClosestPoint<pcl::PointNormal, pcl::PointNormal> icp_;
};

}  // namespace

std::vector<std::unique_ptr<Peer>> pcl_peers(int threads) {
  std::vector<std::unique_ptr<Peer>> peers;
  peers.push_back(std::make_unique<PclPeer>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
