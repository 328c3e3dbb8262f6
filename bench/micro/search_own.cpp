#include "bench/micro/search_peer.hpp"
#include "engine/matching/coded_index.hpp"
#include "engine/matching/make_codes.hpp"

namespace landmarkdb::bench {
namespace {

std::vector<std::uint32_t> nearest_of(const DescriptorIndex& index,
                                      std::span<const float> queries,
                                      int threads) {
  RunContext context;
  context.threads = threads;
  std::vector<DescriptorMatch> found;
  index.search(queries, 1, found, context);
  std::vector<std::uint32_t> rows;
  rows.reserve(found.size());
  for (const DescriptorMatch& match : found) rows.push_back(match.index);
  return rows;
}

class Exact : public SearchPeer {
 public:
  explicit Exact(int threads) : threads_(threads) {}
  std::string name() const override { return "landmarkdb exact"; }
  void build(std::span<const float> stored) override {
    index_ = make_exact_index(stored, Measure::kL2);
  }
  std::vector<std::uint32_t> search(std::span<const float> queries, int) override {
    return nearest_of(*index_, queries, threads_);
  }

 private:
  int threads_;
  std::unique_ptr<DescriptorIndex> index_;
};

// In parts of the size of a place, as a server has them.
class Coded : public SearchPeer {
 public:
  explicit Coded(int threads) : threads_(threads) {}
  std::string name() const override { return "landmarkdb coded"; }
  void build(std::span<const float> stored) override {
    constexpr std::size_t kRowsAPart = 16'000;
    RunContext context;
    context.threads = threads_;
    const std::size_t rows = stored.size() / kShotLength;
    const std::size_t count = (rows + kRowsAPart - 1) / kRowsAPart;
    tails_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t begin = i * rows / count;
      const std::size_t end = (i + 1) * rows / count;
      const auto part = stored.subspan(begin * kShotLength, (end - begin) * kShotLength);
      const DescriptorCodes codes = make_codes(part, context);
      tails_[i] = tails_by_row(codes);
      parts_.push_back({part, make_coded_part(codes, end - begin), tails_[i]});
    }
  }
  std::vector<int> efforts() const override { return {64, 32, 16, 8}; }
  std::string effort_name() const override { return "one list of"; }
  std::vector<std::uint32_t> search(std::span<const float> queries, int effort) override {
    if (effort != effort_) {  // the first of several searches, whose fastest counts
      index_ = make_coded_index(parts_, {.list_share = 1.0 / effort});
      effort_ = effort;
    }
    return nearest_of(*index_, queries, threads_);
  }

 private:
  int threads_;
  int effort_ = 0;
  std::vector<std::vector<std::int8_t>> tails_;
  std::vector<IndexedPart> parts_;
  std::unique_ptr<DescriptorIndex> index_;
};

}  // namespace

SearchPeers own_peers(int threads) {
  SearchPeers peers;
  peers.push_back(std::make_unique<Exact>(threads));
  peers.push_back(std::make_unique<Coded>(threads));
  return peers;
}

}  // namespace landmarkdb::bench
