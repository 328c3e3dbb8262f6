#include "bench/mono/pose_peer.hpp"

namespace landmarkdb::bench {

std::vector<PosePeer> pose_peers(std::size_t, bool) { return {}; }

}  // namespace landmarkdb::bench
