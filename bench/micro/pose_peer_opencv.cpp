#include <opencv2/calib3d.hpp>

#include "bench/micro/pose_peer.hpp"

namespace landmarkdb::bench {
namespace {

struct Input {
  Input(const std::vector<PosePoint>& points, const Camera& camera)
      : K(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1) {
    for (const PosePoint& point : points) {
      xyz.emplace_back(point.xyz.x(), point.xyz.y(), point.xyz.z());
      uv.emplace_back(point.uv.x(), point.uv.y());
    }
  }
  std::vector<cv::Point3d> xyz;
  std::vector<cv::Point2d> uv;
  cv::Matx33d K;
};

void add(const cv::Vec3d& turn, const cv::Vec3d& shift, FoundPoses& found) {
  cv::Matx33d R;
  cv::Rodrigues(turn, R);
  RigidPose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.R(row, column) = R(row, column);
    pose.t[row] = shift[row];
  }
  if (pose.R.allFinite() && pose.t.allFinite()) found.push_back(pose);
}

template <int kMethod, bool kRefined>
FoundPoses solve(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  cv::Vec3d turn, shift;
  FoundPoses found;
  try {
    if (!cv::solvePnP(in.xyz, in.uv, in.K, cv::noArray(), turn, shift, false, kMethod)) return {};
    if (kRefined) cv::solvePnPRefineLM(in.xyz, in.uv, in.K, cv::noArray(), turn, shift);
    add(turn, shift, found);
  } catch (const cv::Exception&) {
    return {};
  }
  return found;
}

template <int kMethod>
FoundPoses solve_three(const std::vector<PosePoint>& points, const Camera& camera) {
  const Input in(points, camera);
  std::vector<cv::Vec3d> turns, shifts;
  FoundPoses found;
  try {
    cv::solveP3P(in.xyz, in.uv, in.K, cv::noArray(), turns, shifts, kMethod);
  } catch (const cv::Exception&) {
    return {};
  }
  for (std::size_t i = 0; i < turns.size(); ++i) add(turns[i], shifts[i], found);
  return found;
}

}  // namespace

std::vector<PosePeer> opencv_pose_peers(std::size_t n, bool planar) {
  constexpr std::size_t kLeastForDlt = 6;  // ITERATIVE's start, for points that are not planar
  if (n == 3) {
    return {{"OpenCV P3P", solve_three<cv::SOLVEPNP_P3P>},
            {"OpenCV AP3P", solve_three<cv::SOLVEPNP_AP3P>}};
  }
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
