#include "bench/micro/pose_peer.hpp"

namespace landmarkdb::bench {

std::vector<PosePeer> opencv_pose_peers(std::size_t, bool) { return {}; }

}  // namespace landmarkdb::bench
