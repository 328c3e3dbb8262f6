#include "bench/retrieval/peer.hpp"

namespace landmarkdb::bench {

std::vector<std::unique_ptr<Peer>> pcl_peers(int) { return {}; }

}  // namespace landmarkdb::bench
