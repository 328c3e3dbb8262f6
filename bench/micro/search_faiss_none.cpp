#include "bench/micro/search_peer.hpp"

namespace landmarkdb::bench {

SearchPeers faiss_peers(int) { return {}; }

}  // namespace landmarkdb::bench
