#include "bench/micro/pose_peer.hpp"

namespace landmarkdb::bench {

std::vector<PosePeer> opengv_pose_peers(std::size_t, bool) { return {}; }

}  // namespace landmarkdb::bench
