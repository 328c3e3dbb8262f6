// Compiled with -march=native: hnswlib chooses its kernels when it is compiled, and this file
// shares no Eigen or PCL type with another.
#include <atomic>
#include <thread>

#include <hnswlib/hnswlib.h>

#include "bench/micro/search_peer.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb::bench {
namespace {

class Hnswlib : public SearchPeer {
 public:
  explicit Hnswlib(int threads) : threads_(threads) {}
  std::string name() const override { return "hnswlib 16 (native flags)"; }
  void build(std::span<const float> stored) override {
    const std::size_t count = stored.size() / kShotLength;
    graph_ = std::make_unique<hnswlib::HierarchicalNSW<float>>(&space_, count, 16, 100);
    for_each(count, [&](std::size_t i) { graph_->addPoint(stored.data() + i * kShotLength, i); });
  }
  std::vector<int> efforts() const override { return {64, 128, 256, 512}; }
  std::string effort_name() const override { return "ef"; }
  std::vector<std::uint32_t> search(std::span<const float> queries, int effort) override {
    graph_->setEf(static_cast<std::size_t>(effort));
    std::vector<std::uint32_t> rows(queries.size() / kShotLength);
    for_each(rows.size(), [&](std::size_t i) {
      const auto found = graph_->searchKnn(queries.data() + i * kShotLength, 1);
      rows[i] = static_cast<std::uint32_t>(found.top().second);
    });
    return rows;
  }

 private:
  template <typename Work>
  void for_each(std::size_t count, const Work& work) const {
    std::atomic<std::size_t> next{0};
    std::vector<std::jthread> pool;
    for (int t = 0; t < threads_; ++t) {
      pool.emplace_back([&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
      });
    }
  }
  int threads_;
  hnswlib::L2Space space_{kShotLength};
  std::unique_ptr<hnswlib::HierarchicalNSW<float>> graph_;
};

}  // namespace

SearchPeers hnswlib_peers(int threads) {
  SearchPeers peers;
  peers.push_back(std::make_unique<Hnswlib>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
