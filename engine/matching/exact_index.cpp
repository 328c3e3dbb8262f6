#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/matching/descriptor_rows.hpp"
#include "engine/matching/dot_tiles.hpp"
#include "engine/matching/measures.hpp"
#include "engine/matching/nearest_list.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "match";

// Queries that go over the stored descriptors together: 1024 of them packed are 1.4 MB, which
// stays in the second-level cache, and packing a tile of targets vanishes beside multiplying it.
constexpr std::size_t kQueryBlock = 1024;

// Candidates of a query that wait to be evaluated exactly; a small multiple of the usual k of ten.
constexpr std::size_t kPending = 64;

// An inner product of two unit vectors of 352 floats is off by at most 352 * 2^-24 = 2.1e-5 in any
// order of summation, the exact evaluation and the lengths by 2e-6 more. With twice that as margin
// no true neighbour is passed over, so the answer does not depend on kernel or blocking.
constexpr float kMargin = 5e-5F;

// One query's state while it goes over the stored descriptors.
struct Seeker {
  std::span<const float> query;  // normalised
  NearestList nearest;
  std::array<std::uint32_t, kPending> pending{};
  std::size_t waiting = 0;
  float half_length = 0.0F;  // half the squared length of `query`
  // A target whose inner product, less half its own squared length, is below this is farther than
  // the k-th.
  float floor = -std::numeric_limits<float>::infinity();
};

float half_squared_length(std::span<const float> row) {
  float sum = 0.0F;
  for (const float v : row) sum += v * v;
  return 0.5F * sum;
}

class ExactIndex : public DescriptorIndex {
 public:
  ExactIndex(std::span<const float> values, Measure measure)
      : measure_(measure), rows_(normalise_rows(values, measure, "stored descriptors")) {
    if (!is_euclidean(measure_)) return;
    half_length_.reserve(size());
    for (std::size_t i = 0; i < size(); ++i) {
      half_length_.push_back(half_squared_length(descriptor_row(rows_, i)));
    }
  }

  std::size_t size() const override { return rows_.size() / kShotLength; }

  void search(std::span<const float> queries,
              std::size_t k,
              std::vector<DescriptorMatch>& out,
              const RunContext& context) const override {
    context.check(kStage);
    const std::vector<float> normalised = normalise_rows(queries, measure_, "query descriptors");
    const std::size_t count = normalised.size() / kShotLength;
    out.assign(count * k, {});
    if (count == 0 || k == 0 || size() == 0) return;

    const std::size_t threads = static_cast<std::size_t>(std::max(context.threads, 1));
    const std::size_t blocks =
        std::min(count, std::max(threads, (count + kQueryBlock - 1) / kQueryBlock));
    std::atomic<std::size_t> next{0};
    parallel_chunks(std::min(threads, blocks), context.threads, [&](std::size_t, std::size_t) {
      while (!context.should_stop()) {
        const std::size_t block = next.fetch_add(1);
        if (block >= blocks) return;
        const std::size_t begin = count * block / blocks;
        const std::size_t end = count * (block + 1) / blocks;
        search_block(std::span<const float>(normalised)
                         .subspan(begin * kShotLength, (end - begin) * kShotLength),
                     k,
                     out.data() + begin * k,
                     context);
      }
    });
    context.check(kStage);
  }

 private:
  void search_block(std::span<const float> queries,
                    std::size_t k,
                    DescriptorMatch* out,
                    const RunContext& context) const {
    std::vector<Seeker> seekers;
    for (std::size_t i = 0; i < queries.size() / kShotLength; ++i) {
      const std::span<const float> query = descriptor_row(queries, i);
      seekers.push_back({.query = query, .nearest = NearestList(k)});
      seekers.back().half_length = half_squared_length(query);
    }
    if (is_euclidean(measure_)) {
      search_by_product(seekers, context);
    } else {
      search_by_loop(seekers, context);
    }
    for (std::size_t i = 0; i < seekers.size(); ++i) seekers[i].nearest.write(out + i * k);
  }

  // Target rows outside, queries inside: a few targets stay in the first-level cache.
  void search_by_loop(std::vector<Seeker>& seekers, const RunContext& context) const {
    for (std::size_t tile = 0; tile < size() && !context.should_stop(); tile += kTileTargets) {
      const std::size_t end = std::min(tile + kTileTargets, size());
      for (Seeker& seeker : seekers) {
        for (std::size_t target = tile; target < end; ++target) evaluate(seeker, target);
      }
    }
  }

  void search_by_product(std::vector<Seeker>& seekers, const RunContext& context) const {
    const DotKernel& kernel = dot_kernel();
    const std::vector<float> queries = pack_queries(seekers, kernel.queries);
    std::vector<float> targets(kTileTargets * kShotLength);
    std::array<float, kTileTargets> half_length{};
    std::array<float, kMaxTileQueries * kTileTargets> products{};
    for (std::size_t tile = 0; tile < size() && !context.should_stop(); tile += kTileTargets) {
      pack_targets(tile, targets, half_length);
      for (std::size_t first = 0; first < seekers.size(); first += kernel.queries) {
        kernel.tile(
            queries.data() + first * kShotLength, targets.data(), kShotLength, products.data());
        const std::size_t last = std::min(first + kernel.queries, seekers.size());
        for (std::size_t i = first; i < last; ++i) {
          const float* row = products.data() + (i - first) * kTileTargets;
          take_candidates(seekers[i], row, half_length, tile);
        }
      }
    }
    for (Seeker& seeker : seekers) settle(seeker);
  }

  static std::vector<float> pack_queries(const std::vector<Seeker>& seekers,
                                         std::size_t tile_queries) {
    const std::size_t tiles = (seekers.size() + tile_queries - 1) / tile_queries;
    std::vector<float> packed(tiles * tile_queries * kShotLength, 0.0F);
    for (std::size_t i = 0; i < seekers.size(); ++i) {
      float* tile = packed.data() + i / tile_queries * tile_queries * kShotLength;
      for (std::size_t j = 0; j < kShotLength; ++j) {
        tile[j * tile_queries + i % tile_queries] = seekers[i].query[j];
      }
    }
    return packed;
  }

  // Places past the last descriptor are infinitely far.
  void pack_targets(std::size_t first,
                    std::vector<float>& packed,
                    std::array<float, kTileTargets>& half_length) const {
    const std::size_t count = std::min(kTileTargets, size() - first);
    half_length.fill(std::numeric_limits<float>::infinity());
    if (count < kTileTargets) std::fill(packed.begin(), packed.end(), 0.0F);
    for (std::size_t i = 0; i < count; ++i) half_length[i] = half_length_[first + i];
    const float* rows = rows_.data() + first * kShotLength;
    for (std::size_t j = 0; j < kShotLength; ++j) {
      for (std::size_t i = 0; i < count; ++i) {
        packed[j * kTileTargets + i] = rows[i * kShotLength + j];
      }
    }
  }

  void take_candidates(Seeker& seeker,
                       const float* products,
                       const std::array<float, kTileTargets>& half_length,
                       std::size_t first) const {
    // One pass without branches, as most tiles hold no candidate.
    unsigned candidates = 0;
    for (std::size_t j = 0; j < kTileTargets; ++j) {
      candidates += products[j] - half_length[j] >= seeker.floor ? 1U : 0U;
    }
    if (candidates == 0) return;
    const std::size_t count = std::min(kTileTargets, size() - first);
    for (std::size_t j = 0; j < count; ++j) {
      if (products[j] - half_length[j] < seeker.floor) continue;
      seeker.pending[seeker.waiting++] = static_cast<std::uint32_t>(first + j);
      if (seeker.waiting == kPending) settle(seeker);
    }
  }

  // Evaluates the candidates that wait and raises the floor to the k-th of what is known.
  void settle(Seeker& seeker) const {
    for (std::size_t i = 0; i < seeker.waiting; ++i) evaluate(seeker, seeker.pending[i]);
    seeker.waiting = 0;
    if (!seeker.nearest.full()) return;
    const float farthest = seeker.nearest.farthest();
    const float half_squared = measure_ == Measure::kCorrelation ? farthest : farthest * farthest;
    seeker.floor = seeker.half_length - half_squared - kMargin;
  }

  void evaluate(Seeker& seeker, std::size_t target) const {
    const float distance =
        normalised_dissimilarity(measure_, seeker.query, descriptor_row(rows_, target));
    seeker.nearest.offer({static_cast<std::uint32_t>(target), distance});
  }

  Measure measure_;
  std::vector<float> rows_;         // N x kShotLength, normalised
  std::vector<float> half_length_;  // half the squared length of each row; Euclidean measures only
};

}  // namespace

std::unique_ptr<DescriptorIndex> make_exact_index(std::span<const float> values, Measure measure) {
  return std::make_unique<ExactIndex>(values, measure);
}

}  // namespace landmarkdb
