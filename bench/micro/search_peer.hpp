#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace landmarkdb::bench {

// One way to find nearest descriptors, ours or another's, at one or several efforts.
class SearchPeer {
 public:
  virtual ~SearchPeer() = default;
  virtual std::string name() const = 0;
  // `stored` is N x kShotLength and outlives the peer.
  virtual void build(std::span<const float> stored) = 0;
  // What its searches are tried with, cheapest first: what the numbers mean is in effort_name().
  virtual std::vector<int> efforts() const { return {0}; }
  virtual std::string effort_name() const { return ""; }
  // The row of the nearest of each query, in l2.
  virtual std::vector<std::uint32_t> search(std::span<const float> queries, int effort) = 0;
  // Queries asked, where it is so slow that all would take minutes.
  virtual std::size_t most_queries(std::size_t /*stored*/) const { return 1U << 30U; }
};

using SearchPeers = std::vector<std::unique_ptr<SearchPeer>>;

// Each empty where the library is not installed.
SearchPeers own_peers(int threads);
SearchPeers flann_peers(int threads);  // FLANN's, and PCL's kd-tree over it
SearchPeers faiss_peers(int threads);
SearchPeers hnswlib_peers(int threads);
SearchPeers openblas_peers(int threads);

}  // namespace landmarkdb::bench
