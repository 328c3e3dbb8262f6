#include <opencv2/calib3d.hpp>

#include "bench/mono/pose_peer.hpp"

namespace landmarkdb::bench {
namespace {

template <int kMethod, bool kRefined>
bool solve(const std::vector<PosePoint>& points, const Camera& camera, RigidPose& pose) {
  std::vector<cv::Point3d> xyz;
  std::vector<cv::Point2d> uv;
  for (const PosePoint& point : points) {
    xyz.emplace_back(point.xyz.x(), point.xyz.y(), point.xyz.z());
    uv.emplace_back(point.uv.x(), point.uv.y());
  }
  const cv::Matx33d K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d turn, shift;
  try {
    if (!cv::solvePnP(xyz, uv, K, cv::noArray(), turn, shift, false, kMethod)) return false;
    if (kRefined) cv::solvePnPRefineLM(xyz, uv, K, cv::noArray(), turn, shift);
  } catch (const cv::Exception&) {
    return false;
  }
  cv::Matx33d R;
  cv::Rodrigues(turn, R);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.R(row, column) = R(row, column);
    pose.t[row] = shift[row];
  }
  return pose.R.allFinite() && pose.t.allFinite();
}

}  // namespace

std::vector<PosePeer> pose_peers(std::size_t n, bool planar) {
  constexpr std::size_t kLeastForDlt = 6;  // its start, for points that are not planar
  std::vector<PosePeer> peers;
  if (planar || n >= kLeastForDlt) {
    peers.push_back({"OpenCV ITERATIVE", solve<cv::SOLVEPNP_ITERATIVE, false>});
  }
  peers.push_back({"OpenCV SQPNP", solve<cv::SOLVEPNP_SQPNP, false>});
  peers.push_back({"OpenCV SQPNP + LM", solve<cv::SOLVEPNP_SQPNP, true>});
  peers.push_back({"OpenCV EPNP", solve<cv::SOLVEPNP_EPNP, false>});
  if (planar) {
    peers.push_back({"OpenCV IPPE", solve<cv::SOLVEPNP_IPPE, false>});
    peers.push_back({"OpenCV IPPE + LM", solve<cv::SOLVEPNP_IPPE, true>});
  }
  return peers;
}

}  // namespace landmarkdb::bench
