#include "bench/retrieval/peer.hpp"

namespace landmarkdb::bench {

std::vector<std::unique_ptr<Peer>> open3d_peers() { return {}; }

}  // namespace landmarkdb::bench
