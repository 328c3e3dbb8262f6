#include "engine/matching/coded_index.hpp"

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/base/put_largest_first.hpp"
#include "engine/matching/code_kernels.hpp"
#include "engine/matching/descriptor_rows.hpp"
#include "engine/matching/make_codes.hpp"
#include "engine/matching/measures.hpp"
#include "engine/matching/near_lists.hpp"
#include "engine/matching/nearest_list.hpp"
#include "engine/matching/shortlist.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "match";
constexpr std::uint32_t kNoRow = CodedPart::kNoRow;

// Queries that go over the lists together, so that a list is read once for all who want it.
constexpr std::size_t kQueryBlock = 1024;

// The lists nearest to a query are read before all others: what they hold rules out most of the
// rest.
constexpr std::size_t kFirstLists = 16;

// Reads ahead: what lies here is wanted a few rows later, and comes from memory.
void prefetch(const void* from, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < bytes; i += kLine) {
    __builtin_prefetch(static_cast<const char*>(from) + i);
  }
}

// Who wants which list, sorted by list.
struct Wishes {
  std::vector<std::uint32_t> start;    // of each list in `queries`, and the end
  std::vector<std::uint32_t> queries;  // of the block

  std::span<const std::uint32_t> of(std::size_t list) const {
    return std::span(queries).subspan(start[list], start[list + 1] - start[list]);
  }
};

// Rows of which tails are read, and rows that are compared in full.
struct Effort {
  std::size_t refined = 0, compared = 0;
};

std::size_t share_of(double share, std::size_t count) {
  return static_cast<std::size_t>(share * static_cast<double>(count));
}

Effort effort_of(const CodedSearchOptions& options, std::size_t k) {
  return {options.refined + share_of(options.refined_a_neighbour, k),
          options.compared + share_of(options.compared_a_neighbour, k)};
}

}  // namespace

class CodedIndexMaker::Index : public CodedIndex {
 public:
  Index(const CodedSearchOptions& options, std::size_t rows) : options_(options) {
    if (options_.keeps_tails) tails_.reserve(rows * kCodeLength);
  }

  void add(const IndexedPart& part) {
    assert(part.codes != nullptr && "a part has codes");
    const CodedPart& codes = *part.codes;
    if ((part.values.empty() && codes.rows > 0) || !options_.keeps_tails) {
      compares_in_full_ = false;
    }
    if (!part.values.empty() && part.values.size() != codes.rows * kShotLength) {
      throw Error(ErrorCode::kInvalidArgument,
                  "the index has search codes of " + std::to_string(codes.rows) + " rows for " +
                      std::to_string(part.values.size() / kShotLength) + " descriptors");
    }
    if (options_.keeps_tails && part.tails.size() != codes.rows * kCodeLength) {
      throw Error(ErrorCode::kInvalidArgument, "the index has search codes without their tails");
    }
    if (codes.rows >= kNoRow - size_) {
      throw Error(ErrorCode::kInvalidArgument, "stored descriptors are 2^32 - 1 or more");
    }
    first_list_.push_back(lists_.size());
    add_lists(codes);
    if (options_.keeps_tails) tails_.insert(tails_.end(), part.tails.begin(), part.tails.end());
    first_row_.push_back(size_);
    values_.push_back(part.values);
    codes_.push_back(part.codes);
    size_ += codes.rows;
  }

  void finish() {
    first_list_.push_back(lists_.size());
    centres_.finish();
  }

  std::size_t size() const override { return size_; }

  bool has_tails() const override { return options_.keeps_tails; }

  void search(std::span<const float> queries,
              std::size_t k,
              std::vector<DescriptorMatch>& out,
              const RunContext& context) const override {
    search_blocks(
        queries,
        k,
        effort_of(options_, k),
        out,
        context,
        [&](const Block& block, auto& shortlists) { read_near_lists(block, shortlists, context); });
  }

  void search_parts(std::span<const std::size_t> parts,
                    std::span<const float> queries,
                    std::size_t k,
                    std::vector<DescriptorMatch>& out,
                    const RunContext& context) const override {
    search_blocks(queries,
                  k,
                  effort_of(kScanOptions, k),
                  out,
                  context,
                  [&](const Block& block, auto& shortlists) {
                    std::vector<std::uint32_t> all(block.size());
                    std::iota(all.begin(), all.end(), 0U);
                    ListReader reader(*this);
                    for (const std::size_t part : parts) {
                      for (std::size_t l = first_list_[part]; l < first_list_[part + 1]; ++l) {
                        if (context.should_stop()) return;
                        reader.read(block, l, all, shortlists);
                      }
                    }
                  });
  }

 private:
  // Queries begin .. end - 1 of all.
  struct Block {
    std::span<const float> rows;
    const RowCodes& codes;
    std::size_t begin = 0;
    std::size_t end = 0;

    std::size_t size() const { return end - begin; }
    const std::int8_t* code(std::size_t i) const {
      return codes.codes.data() + (begin + i) * kCodeLength;
    }
    const std::int8_t* tail(std::size_t i) const {
      return codes.tails.data() + (begin + i) * kCodeLength;
    }
    std::span<const float> row(std::size_t i) const { return descriptor_row(rows, begin + i); }
  };

  // One list of a part, as the kernels read it.
  struct List {
    const std::uint8_t* bytes;
    const std::int32_t* bias;
    const std::uint32_t* row_of;  // of the part
    std::uint32_t groups;
    std::uint32_t first_row;  // of the part
  };

  void add_lists(const CodedPart& part) {
    for (std::size_t l = 0; l < part.lists(); ++l) {
      const std::size_t group = part.list_start[l];
      const std::uint32_t groups = part.list_start[l + 1] - part.list_start[l];
      lists_.push_back({part.codes.bytes.data() + group * kCodeGroup * kCodeLength,
                        part.codes.bias.data() + group * kCodeGroup,
                        part.row_of.data() + group * kCodeGroup,
                        groups,
                        static_cast<std::uint32_t>(size_)});
      most_in_list_ = std::max(most_in_list_, groups * kCodeGroup);
      centres_.add(std::span(part.centres).subspan(l * kCodeLength, kCodeLength));
    }
  }

  std::size_t lists() const { return lists_.size(); }

  // `read` offers the rows that are looked at to the shortlists of a block of queries.
  template <typename Read>
  void search_blocks(std::span<const float> queries,
                     std::size_t k,
                     const Effort& effort,
                     std::vector<DescriptorMatch>& out,
                     const RunContext& context,
                     const Read& read) const {
    context.check(kStage);
    const std::vector<float> rows = normalise_rows(queries, Measure::kL2, "query descriptors");
    const std::size_t count = rows.size() / kShotLength;
    out.assign(count * k, {});
    if (count == 0 || k == 0 || size_ == 0) return;
    const RowCodes codes = code_rows(rows, context);
    parallel_chunks(count, context.threads, [&](std::size_t begin, std::size_t end) {
      for (; begin < end && !context.should_stop(); begin += kQueryBlock) {
        const Block block{rows, codes, begin, std::min(begin + kQueryBlock, end)};
        std::vector<Shortlist> shortlists(block.size());
        const std::size_t most = has_tails() ? std::max({effort.refined, effort.compared, k}) : k;
        for (Shortlist& shortlist : shortlists) shortlist.reset(most);
        read(block, shortlists);
        for (std::size_t i = 0; i < block.size() && !context.should_stop(); ++i) {
          write_best(block, i, shortlists[i].best(), effort, k, out);
        }
      }
    });
    context.check(kStage);
  }

  // The `k` best of the candidates of a query, once they have been looked at more closely.
  void write_best(const Block& block,
                  std::size_t i,
                  std::span<CodeCandidate> candidates,
                  const Effort& effort,
                  std::size_t k,
                  std::vector<DescriptorMatch>& out) const {
    DescriptorMatch* found = out.data() + (block.begin + i) * k;
    if (compares_in_full_) {
      compare(block.row(i), refine(block.tail(i), candidates, effort.compared), k, found);
    } else {
      rank(block.code(i), has_tails() ? refine(block.tail(i), candidates, k) : candidates, found);
    }
  }

  void read_near_lists(const Block& block,
                       std::vector<Shortlist>& shortlists,
                       const RunContext& context) const {
    const std::size_t probes =
        std::min(lists(), std::max(options_.min_lists, share_of(options_.list_share, lists())));
    const std::size_t first = std::min(probes, kFirstLists);
    std::vector<std::uint32_t> chosen(block.size() * probes);
    NearLists::Scratch scratch;
    for (std::size_t i = 0; i < block.size(); ++i) {
      centres_.choose(block.code(i), first, std::span(chosen).subspan(i * probes, probes), scratch);
    }
    read_lists(block, wishes_for(chosen, probes, 0, first), shortlists, context);
    read_lists(block, wishes_for(chosen, probes, first, probes), shortlists, context);
  }

  Wishes wishes_for(const std::vector<std::uint32_t>& chosen,
                    std::size_t probes,
                    std::size_t first,
                    std::size_t last) const {
    Wishes wishes;
    wishes.start.resize(lists() + 1);
    const std::size_t count = chosen.size() / probes;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = first; j < last; ++j) ++wishes.start[chosen[i * probes + j] + 1];
    }
    for (std::size_t l = 0; l < lists(); ++l) wishes.start[l + 1] += wishes.start[l];
    wishes.queries.resize(count * (last - first));
    std::vector<std::uint32_t> next(wishes.start.begin(), wishes.start.end() - 1);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = first; j < last; ++j) {
        wishes.queries[next[chosen[i * probes + j]]++] = static_cast<std::uint32_t>(i);
      }
    }
    return wishes;
  }

  // Compares the codes of one list after the other.
  class ListReader {
   public:
    explicit ListReader(const Index& index) : index_(index) {
      hits_.make_room(index.most_in_list_);
    }

    void read(const Block& block,
              std::size_t list,
              std::span<const std::uint32_t> queries,
              std::vector<Shortlist>& shortlists) {
      const List& here = index_.lists_[list];
      for (const std::uint32_t query : queries) {
        Shortlist& shortlist = shortlists[query];
        const std::size_t count = kernels_.above(block.code(query),
                                                 here.bytes,
                                                 here.bias,
                                                 here.groups,
                                                 shortlist.floor(),
                                                 hits_.scores.data(),
                                                 hits_.places.data());
        for (std::size_t h = 0; h < count; ++h) {
          const std::uint32_t row = here.row_of[hits_.places[h]];
          if (row != kNoRow) shortlist.offer(make_candidate(hits_.scores[h], here.first_row + row));
        }
      }
    }

   private:
    const Index& index_;
    const CodeKernels& kernels_ = code_kernels();
    CodeHits hits_;
  };

  void read_lists(const Block& block,
                  const Wishes& wishes,
                  std::vector<Shortlist>& shortlists,
                  const RunContext& context) const {
    ListReader reader(*this);
    for (std::size_t l = 0; l < lists() && !context.should_stop(); ++l) {
      reader.read(block, l, wishes.of(l), shortlists);
    }
  }

  // The best `most` of the candidates once their tails are counted in.
  std::span<CodeCandidate> refine(const std::int8_t* tail,
                                  std::span<CodeCandidate> candidates,
                                  std::size_t most) const {
    constexpr std::size_t kAhead = 16;
    const CodeKernels& kernels = code_kernels();
    const auto tail_of = [&](CodeCandidate candidate) {
      return tails_.data() + std::size_t{row_of(candidate)} * kCodeLength;
    };
    for (std::size_t i = 0; i < std::min(kAhead, candidates.size()); ++i) {
      prefetch(tail_of(candidates[i]), kCodeLength);
    }
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i + kAhead < candidates.size()) prefetch(tail_of(candidates[i + kAhead]), kCodeLength);
      const std::int32_t farther = kernels.squared_distance(tail, tail_of(candidates[i]));
      candidates[i] = make_candidate(score_of(candidates[i]) - farther, row_of(candidates[i]));
    }
    put_largest_first(candidates, most);
    return candidates.first(std::min(most, candidates.size()));
  }

  std::span<const float> values_of(std::size_t row) const {
    const auto above = std::upper_bound(first_row_.begin(), first_row_.end(), row);
    const auto part = static_cast<std::size_t>(above - first_row_.begin()) - 1;
    return descriptor_row(values_[part], row - first_row_[part]);
  }

  void compare(std::span<const float> query,
               std::span<const CodeCandidate> candidates,
               std::size_t k,
               DescriptorMatch* out) const {
    constexpr std::size_t kAhead = 2;
    NearestList nearest(k);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (i + kAhead < candidates.size()) {
        const auto next = values_of(row_of(candidates[i + kAhead]));
        prefetch(next.data(), next.size_bytes());
      }
      const std::uint32_t row = row_of(candidates[i]);
      nearest.offer({row, normalised_dissimilarity(Measure::kL2, query, values_of(row))});
    }
    nearest.write(out);
  }

  // The nearest by code and tail alone. A score is |a|^2 + 256 sum(a) less the squared distance.
  static void rank(const std::int8_t* code,
                   std::span<CodeCandidate> candidates,
                   DescriptorMatch* out) {
    constexpr std::int32_t kOffset = 2 * 128;  // see CodeKernels
    std::int32_t at_zero = 0;
    for (std::size_t j = 0; j < kCodeLength; ++j) at_zero += code[j] * (code[j] + kOffset);
    std::sort(candidates.begin(), candidates.end(), std::greater<>());
    for (const CodeCandidate candidate : candidates) {
      const std::int32_t squared = std::max(at_zero - score_of(candidate), 0);
      *out++ = {row_of(candidate), dissimilarity_of_codes(squared)};
    }
  }

  CodedSearchOptions options_;
  bool compares_in_full_ = true;
  std::vector<std::shared_ptr<const CodedPart>> codes_;  // what `lists_` points into
  std::vector<List> lists_;
  std::vector<std::int8_t> tails_;              // by row
  NearLists centres_;                           // of the lists
  std::vector<std::size_t> first_list_;         // of each part, and the number of lists
  std::vector<std::size_t> first_row_;          // of each part
  std::vector<std::span<const float>> values_;  // of each part
  std::size_t size_ = 0;
  std::size_t most_in_list_ = 0;
};

CodedIndexMaker::CodedIndexMaker(const CodedSearchOptions& options, std::size_t rows)
    : index_(std::make_unique<Index>(options, rows)) {}
CodedIndexMaker::~CodedIndexMaker() = default;

void CodedIndexMaker::add(const IndexedPart& part) { index_->add(part); }

std::unique_ptr<CodedIndex> CodedIndexMaker::finish() {
  index_->finish();
  return std::move(index_);
}

std::unique_ptr<CodedIndex> make_coded_index(std::span<const IndexedPart> parts,
                                             const CodedSearchOptions& options) {
  CodedIndexMaker maker(options);
  for (const IndexedPart& part : parts) maker.add(part);
  return maker.finish();
}

}  // namespace landmarkdb
