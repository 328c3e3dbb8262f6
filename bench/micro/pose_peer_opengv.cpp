#include <limits>

#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>

#include "bench/micro/pose_peer.hpp"

namespace landmarkdb::bench {
namespace {

using opengv::transformation_t;
using opengv::absolute_pose::CentralAbsoluteAdapter;

// OpenGV takes unit rays, and gives the camera's pose in the object's frame.
struct Input {
  Input(const std::vector<PosePoint>& points, const Camera& camera) {
    for (const PosePoint& point : points) {
      xyz.push_back(point.xyz);
      rays.push_back(Eigen::Vector3d((point.uv.x() - camera.cx) / camera.fx,
                                     (point.uv.y() - camera.cy) / camera.fy,
                                     1.0)
                         .normalized());
    }
  }
  opengv::points_t xyz;
  opengv::bearingVectors_t rays;
};

RigidPose pose_from(const transformation_t& T_object_camera) {
  RigidPose pose;
  pose.R = T_object_camera.leftCols<3>().transpose();
  pose.t = -pose.R * T_object_camera.col(3);
  return pose;
}

void add(const transformation_t& T_object_camera, FoundPoses& found) {
  const RigidPose pose = pose_from(T_object_camera);
  if (pose.R.allFinite() && pose.t.allFinite()) found.push_back(pose);
}

// Several poses: the one whose points lie best on their rays comes first.
FoundPoses best_of(const opengv::transformations_t& poses, const Input& in) {
  FoundPoses found;
  double least = std::numeric_limits<double>::infinity();
  for (const transformation_t& T : poses) {
    const RigidPose pose = pose_from(T);
    double cost = 0.0;
    for (std::size_t i = 0; i < in.xyz.size(); ++i) {
      cost += 1.0 - in.rays[i].dot((pose * in.xyz[i]).normalized());
    }
    if (!(cost < least)) continue;
    least = cost;
    found = {pose};
  }
  return found;
}

FoundPoses upnp(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  const CentralAbsoluteAdapter adapter(in.rays, in.xyz);
  return best_of(opengv::absolute_pose::upnp(adapter), in);
}

template <bool kRefined>
FoundPoses epnp(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  CentralAbsoluteAdapter adapter(in.rays, in.xyz);
  transformation_t T = opengv::absolute_pose::epnp(adapter);
  if (kRefined) {
    adapter.setR(T.leftCols<3>());
    adapter.sett(T.col(3));
    T = opengv::absolute_pose::optimize_nonlinear(adapter);
  }
  FoundPoses found;
  add(T, found);
  return found;
}

FoundPoses kneip(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  const CentralAbsoluteAdapter adapter(in.rays, in.xyz);
  FoundPoses found;
  for (const transformation_t& T : opengv::absolute_pose::p3p_kneip(adapter)) add(T, found);
  return found;
}

FoundPoses gao(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  const CentralAbsoluteAdapter adapter(in.rays, in.xyz);
  FoundPoses found;
  for (const transformation_t& T : opengv::absolute_pose::p3p_gao(adapter)) add(T, found);
  return found;
}

}  // namespace

std::vector<PosePeer> opengv_pose_peers(std::size_t n, bool planar) {
  if (n == 3) return {{"OpenGV P3P Kneip", kneip}, {"OpenGV P3P Gao", gao}};
  std::vector<PosePeer> peers{{"OpenGV UPnP", upnp}};
  // Its EPnP takes six points, and no planes.
  constexpr std::size_t kLeastForEpnp = 6;
  if (!planar && n >= kLeastForEpnp) {
    peers.push_back({"OpenGV EPnP", epnp<false>});
    peers.push_back({"OpenGV EPnP + nonlinear", epnp<true>});
  }
  return peers;
}

}  // namespace landmarkdb::bench
