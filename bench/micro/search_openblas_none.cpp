#include "bench/micro/search_peer.hpp"

namespace landmarkdb::bench {

SearchPeers openblas_peers(int) { return {}; }

}  // namespace landmarkdb::bench
