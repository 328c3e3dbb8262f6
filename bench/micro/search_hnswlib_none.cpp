#include "bench/micro/search_peer.hpp"

namespace landmarkdb::bench {

SearchPeers hnswlib_peers(int) { return {}; }

}  // namespace landmarkdb::bench
