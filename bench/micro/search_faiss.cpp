#include <cmath>

#include <faiss/IndexFlat.h>
#include <faiss/IndexHNSW.h>
#include <faiss/IndexIVFFlat.h>
#include <omp.h>

#include "bench/micro/search_peer.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb::bench {
namespace {

constexpr int kLength = static_cast<int>(kShotLength);

class Faiss : public SearchPeer {
 public:
  explicit Faiss(int threads) : threads_(threads) {}
  void build(std::span<const float> stored) override {
    omp_set_num_threads(threads_);
    const auto count = static_cast<faiss::Index::idx_t>(stored.size() / kShotLength);
    index_ = make(static_cast<double>(count));
    index_->train(count, stored.data());
    index_->add(count, stored.data());
  }
  std::vector<std::uint32_t> search(std::span<const float> queries, int effort) override {
    set_effort(effort);
    const auto count = static_cast<faiss::Index::idx_t>(queries.size() / kShotLength);
    std::vector<faiss::Index::idx_t> found(static_cast<std::size_t>(count));
    std::vector<float> distances(found.size());
    index_->search(count, queries.data(), 1, distances.data(), found.data());
    return {found.begin(), found.end()};
  }

 protected:
  virtual std::unique_ptr<faiss::Index> make(double rows) = 0;
  virtual void set_effort(int) {}
  int threads_;
  std::unique_ptr<faiss::Index> index_;
};

class Flat : public Faiss {
 public:
  using Faiss::Faiss;
  std::string name() const override { return "FAISS flat"; }
  std::unique_ptr<faiss::Index> make(double) override {
    return std::make_unique<faiss::IndexFlatL2>(kLength);
  }
};

class Ivf : public Faiss {
 public:
  using Faiss::Faiss;
  std::string name() const override { return "FAISS IVF flat"; }
  std::unique_ptr<faiss::Index> make(double rows) override {
    const auto lists = static_cast<std::size_t>(std::min(4.0 * std::sqrt(rows), 2048.0));
    auto index = std::make_unique<faiss::IndexIVFFlat>(&centres_, kLength, lists);
    index->cp.max_points_per_centroid = 64;
    index->cp.niter = 8;
    return index;
  }
  std::vector<int> efforts() const override { return {16, 64, 128}; }
  std::string effort_name() const override { return "lists"; }
  void set_effort(int effort) override {
    static_cast<faiss::IndexIVFFlat&>(*index_).nprobe = static_cast<std::size_t>(effort);
  }

 private:
  faiss::IndexFlatL2 centres_{kLength};
};

class Hnsw : public Faiss {
 public:
  using Faiss::Faiss;
  std::string name() const override { return "FAISS HNSW 16"; }
  std::unique_ptr<faiss::Index> make(double) override {
    auto index = std::make_unique<faiss::IndexHNSWFlat>(kLength, 16);
    index->hnsw.efConstruction = 100;
    return index;
  }
  std::vector<int> efforts() const override { return {64, 128, 256, 512}; }
  std::string effort_name() const override { return "ef"; }
  void set_effort(int effort) override {
    static_cast<faiss::IndexHNSWFlat&>(*index_).hnsw.efSearch = effort;
  }
};

}  // namespace

SearchPeers faiss_peers(int threads) {
  SearchPeers peers;
  peers.push_back(std::make_unique<Flat>(threads));
  peers.push_back(std::make_unique<Ivf>(threads));
  peers.push_back(std::make_unique<Hnsw>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
