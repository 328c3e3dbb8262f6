#include <flann/flann.hpp>
#include <pcl/kdtree/impl/kdtree_flann.hpp>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include "bench/micro/search_peer.hpp"
#include "engine/base/parallel.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb::bench {
namespace {

// pcl::KdTreeFLANN: what PCL's own examples match descriptors with. Exact, one query at a time.
class PclTree : public SearchPeer {
 public:
  explicit PclTree(int threads) : threads_(threads) {}
  std::string name() const override { return "pcl::KdTreeFLANN"; }
  void build(std::span<const float> stored) override { tree_.setInputCloud(cloud_of(stored)); }
  std::vector<std::uint32_t> search(std::span<const float> queries, int) override {
    const auto cloud = cloud_of(queries);
    std::vector<std::uint32_t> rows(cloud->size());
    parallel_chunks(rows.size(), threads_, [&](std::size_t begin, std::size_t end) {
      pcl::Indices index(1);
      std::vector<float> distance(1);
      for (std::size_t i = begin; i < end; ++i) {
        tree_.nearestKSearch((*cloud)[i], 1, index, distance);
        rows[i] = static_cast<std::uint32_t>(index[0]);
      }
    });
    return rows;
  }
  std::size_t most_queries(std::size_t stored) const override {
    return std::max<std::size_t>(50, 20'000'000 / stored);
  }

 private:
  using Cloud = pcl::PointCloud<pcl::SHOT352>;
  static Cloud::Ptr cloud_of(std::span<const float> rows) {
    Cloud::Ptr cloud(new Cloud);
    cloud->resize(rows.size() / kShotLength);
    for (std::size_t i = 0; i < cloud->size(); ++i) {
      std::copy_n(rows.data() + i * kShotLength, kShotLength, (*cloud)[i].descriptor);
    }
    return cloud;
  }
  int threads_;
  pcl::KdTreeFLANN<pcl::SHOT352> tree_;
};

class FlannTrees : public SearchPeer {
 public:
  explicit FlannTrees(int threads) : threads_(threads) {}
  std::string name() const override { return "FLANN 4 kd-trees"; }
  void build(std::span<const float> stored) override {
    const flann::Matrix<float> rows(
        const_cast<float*>(stored.data()), stored.size() / kShotLength, kShotLength);
    index_ = std::make_unique<flann::Index<flann::L2<float>>>(rows, flann::KDTreeIndexParams(4));
    index_->buildIndex();
  }
  std::vector<int> efforts() const override { return {512, 2048}; }
  std::string effort_name() const override { return "checks"; }
  std::vector<std::uint32_t> search(std::span<const float> queries, int effort) override {
    const std::size_t count = queries.size() / kShotLength;
    std::vector<int> found(count);
    std::vector<float> distances(count);
    flann::Matrix<int> indices(found.data(), count, 1);
    flann::Matrix<float> dists(distances.data(), count, 1);
    flann::SearchParams params(effort);
    params.cores = threads_;
    index_->knnSearch(flann::Matrix<float>(const_cast<float*>(queries.data()), count, kShotLength),
                      indices,
                      dists,
                      1,
                      params);
    return {found.begin(), found.end()};
  }

 private:
  int threads_;
  std::unique_ptr<flann::Index<flann::L2<float>>> index_;
};

}  // namespace

SearchPeers flann_peers(int threads) {
  SearchPeers peers;
  peers.push_back(std::make_unique<PclTree>(threads));
  peers.push_back(std::make_unique<FlannTrees>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
