#include <algorithm>

#include <cblas.h>

#include "bench/micro/search_peer.hpp"
#include "engine/base/parallel.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb::bench {
namespace {

// The plain matrix product, block by block of stored rows, and the largest of each row.
class OpenBlas : public SearchPeer {
 public:
  explicit OpenBlas(int threads) : threads_(threads) { openblas_set_num_threads(threads); }
  std::string name() const override { return "OpenBLAS sgemm"; }
  void build(std::span<const float> stored) override { stored_ = stored; }
  std::vector<std::uint32_t> search(std::span<const float> queries, int) override {
    constexpr std::size_t kBlock = 4096;
    const std::size_t count = queries.size() / kShotLength;
    const std::size_t rows = stored_.size() / kShotLength;
    std::vector<float> products(count * kBlock);
    std::vector<float> best(count, -1.0F);
    std::vector<std::uint32_t> nearest(count);
    for (std::size_t first = 0; first < rows; first += kBlock) {
      const std::size_t block = std::min(kBlock, rows - first);
      cblas_sgemm(CblasRowMajor,
                  CblasNoTrans,
                  CblasTrans,
                  static_cast<int>(count),
                  static_cast<int>(block),
                  kShotLength,
                  1.0F,
                  queries.data(),
                  kShotLength,
                  stored_.data() + first * kShotLength,
                  kShotLength,
                  0.0F,
                  products.data(),
                  static_cast<int>(block));
      parallel_chunks(count, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const float* row = products.data() + i * block;
          const auto* most = std::max_element(row, row + block);
          if (*most > best[i]) {
            best[i] = *most;
            nearest[i] = static_cast<std::uint32_t>(first + static_cast<std::size_t>(most - row));
          }
        }
      });
    }
    return nearest;
  }

 private:
  int threads_;
  std::span<const float> stored_;
};

}  // namespace

SearchPeers openblas_peers(int threads) {
  SearchPeers peers;
  peers.push_back(std::make_unique<OpenBlas>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
