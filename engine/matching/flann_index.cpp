#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <string_view>

#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>
#include <flann/util/matrix.h>
#include <flann/util/params.h>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/matching/descriptor_rows.hpp"
#include "engine/matching/measures.hpp"
#include "engine/matching/nearest_list.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "match";
constexpr int kLeafSize = 10;               // FLANN's own default
constexpr std::size_t kQueriesAtOnce = 16;  // between two looks at the stop request

// One tree over normalised rows. `Distance` ranks them as the measure does: squared l2 for the
// Euclidean measures, l1 for l1 and intersection (on histograms of sum 1, l1 / 2 is
// 1 - intersection), chi2 for chi2. All three add up over the bins and grow with each bin's
// difference, which is what makes a kd-tree exact.
template <typename Distance>
class FlannIndex : public DescriptorIndex {
 public:
  FlannIndex(std::vector<float> rows, Measure measure, float epsilon)
      : measure_(measure), epsilon_(epsilon), rows_(std::move(rows)) {
    if (rows_.empty()) return;
    tree_ = std::make_unique<Tree>(as_matrix(rows_),
                                   flann::KDTreeSingleIndexParams(kLeafSize, /*reorder=*/true));
    tree_->buildIndex();
  }

  std::size_t size() const override { return rows_.size() / kShotLength; }

  void search(std::span<const float> queries,
              std::size_t k,
              std::vector<DescriptorMatch>& out,
              const RunContext& context) const override {
    context.check(kStage);
    std::vector<float> normalised = normalise_rows(queries, measure_, "query descriptors");
    const std::size_t count = normalised.size() / kShotLength;
    out.assign(count * k, {});
    const std::size_t wanted = std::min(k, size());
    if (count == 0 || wanted == 0) return;
    parallel_chunks(count, context.threads, [&](std::size_t begin, std::size_t end) {
      while (begin < end && !context.should_stop()) {
        const std::size_t rows = std::min(end - begin, kQueriesAtOnce);
        search_rows(std::span(normalised).subspan(begin * kShotLength, rows * kShotLength),
                    wanted,
                    k,
                    out.data() + begin * k);
        begin += rows;
      }
    });
    context.check(kStage);
  }

 private:
  using Tree = flann::KDTreeSingleIndex<Distance>;

  // FLANN takes pointers to what it only reads.
  static flann::Matrix<float> as_matrix(std::span<float> rows) {
    return flann::Matrix<float>(rows.data(), rows.size() / kShotLength, kShotLength);
  }

  void search_rows(std::span<float> queries,
                   std::size_t wanted,
                   std::size_t k,
                   DescriptorMatch* out) const {
    const std::size_t count = queries.size() / kShotLength;
    std::vector<std::size_t> indices(count * wanted);
    std::vector<typename Distance::ResultType> distances(count * wanted);
    flann::Matrix<std::size_t> index_matrix(indices.data(), count, wanted);
    flann::Matrix<typename Distance::ResultType> distance_matrix(distances.data(), count, wanted);
    flann::SearchParams params(flann::FLANN_CHECKS_UNLIMITED, epsilon_);
    params.cores = 1;
    try {
      tree_->knnSearch(as_matrix(queries), index_matrix, distance_matrix, wanted, params);
    } catch (const flann::FLANNException& error) {
      throw Error(ErrorCode::kInternal, std::string("FLANN: ") + error.what());
    }
    // Evaluated again by the kernels of the exact index: its numbers, its order.
    for (std::size_t i = 0; i < count; ++i) {
      NearestList nearest(wanted);
      for (std::size_t j = 0; j < wanted; ++j) {
        const std::size_t index = indices[i * wanted + j];
        if (index >= size()) continue;
        nearest.offer({static_cast<std::uint32_t>(index),
                       normalised_dissimilarity(
                           measure_, descriptor_row(queries, i), descriptor_row(rows_, index))});
      }
      nearest.write(out + i * k);
    }
  }

  Measure measure_;
  float epsilon_;
  std::vector<float> rows_;  // N x kShotLength, normalised
  std::unique_ptr<Tree> tree_;
};

}  // namespace

std::unique_ptr<DescriptorIndex> make_flann_index(std::span<const float> values,
                                                  Measure measure,
                                                  float epsilon) {
  if (!(epsilon >= 0.0F) || !std::isfinite(epsilon)) {
    throw Error(ErrorCode::kInvalidArgument,
                "epsilon is " + std::to_string(epsilon) + ", want a number of at least 0");
  }
  std::vector<float> rows = normalise_rows(values, measure, "stored descriptors");
  if (is_euclidean(measure)) {
    return std::make_unique<FlannIndex<flann::L2<float>>>(std::move(rows), measure, epsilon);
  }
  if (measure == Measure::kChi2) {
    return std::make_unique<FlannIndex<flann::ChiSquareDistance<float>>>(
        std::move(rows), measure, epsilon);
  }
  return std::make_unique<FlannIndex<flann::L1<float>>>(std::move(rows), measure, epsilon);
}

}  // namespace landmarkdb
