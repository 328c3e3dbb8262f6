#include "engine/matching/coded_index.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/matching/code_kernels.hpp"
#include "engine/matching/descriptor_rows.hpp"
#include "engine/matching/make_codes.hpp"
#include "engine/matching/measures.hpp"
#include "engine/matching/nearest_list.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "match";
constexpr std::uint32_t kNoRow = DescriptorMatch::kNone;

// Queries that go over the lists together, so that a list is read once for all who want it.
constexpr std::size_t kQueryBlock = 1024;

constexpr std::size_t kSampleStep = 16;
constexpr std::int32_t kLowest = PackedCodes::kNoCode;

// The lists nearest to a query are read before all others: what they hold rules out most of the
// rest.
constexpr std::size_t kFirstLists = 16;

// A score and a row (or list) as one number: more is better, the lower row of two with one score.
using Candidate = std::uint64_t;

Candidate make_candidate(std::int32_t score, std::uint32_t row) {
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31U;
  return static_cast<Candidate>(static_cast<std::uint32_t>(score) ^ kSign) << 32U | ~row;
}
std::int32_t score_of(Candidate candidate) {
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31U;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(candidate >> 32U) ^ kSign);
}
std::uint32_t row_of(Candidate candidate) { return ~static_cast<std::uint32_t>(candidate); }

// The candidate in the middle of a few spread over the range.
Candidate middle_of(std::span<const Candidate> range) {
  constexpr std::size_t kSampled = 9;
  std::array<Candidate, kSampled> sample{};
  for (std::size_t i = 0; i < kSampled; ++i)
    sample[i] = range[i * (range.size() - 1) / (kSampled - 1)];
  std::nth_element(sample.begin(), sample.begin() + kSampled / 2, sample.end());
  return sample[kSampled / 2];
}

// Those above `pivot` ahead of the others; how many there are. Without a branch on what they are,
// of which half would be mispredicted.
std::size_t part(std::span<Candidate> range, Candidate pivot) {
  std::size_t above = 0;
  for (Candidate& candidate : range) {
    const Candidate here = candidate;
    candidate = range[above];
    range[above] = here;
    above += here > pivot ? 1U : 0U;
  }
  return above;
}

// Brings the `most` best to the front, in no order. No two candidates are the same.
void put_best_ahead(std::span<Candidate> candidates, std::size_t most) {
  if (most == 0 || candidates.size() <= most) return;
  constexpr std::size_t kFew = 32;
  while (candidates.size() > kFew) {
    const std::size_t above = part(candidates, middle_of(candidates));
    if (above == most) return;
    if (above > most) {
      candidates = candidates.first(above);
    } else {
      candidates = candidates.subspan(above);
      most -= above;
    }
  }
  std::nth_element(candidates.begin(),
                   candidates.begin() + static_cast<std::ptrdiff_t>(most) - 1,
                   candidates.end(),
                   std::greater<>());
}

// Reads ahead: what lies here is wanted a few rows later, and comes from memory.
void prefetch(const void* from, std::size_t bytes) {
  constexpr std::size_t kLine = 64;
  for (std::size_t i = 0; i < bytes; i += kLine) {
    __builtin_prefetch(static_cast<const char*>(from) + i);
  }
}

// The `most` best candidates offered so far, whatever the order of offers.
class Shortlist {
 public:
  void reset(std::size_t most) {
    most_ = most;
    candidates_.clear();
    floor_ = PackedCodes::kNoCode;
  }
  // Candidates up to this score need not be offered.
  std::int32_t floor() const { return floor_; }
  void offer(Candidate candidate) {
    candidates_.push_back(candidate);
    if (candidates_.size() >= most_ + std::max(most_, kSpare)) prune();
  }
  // The best, in no order, for the caller to change.
  std::span<Candidate> best() {
    if (candidates_.size() > most_) prune();
    return candidates_;
  }

 private:
  void prune() {
    put_best_ahead(candidates_, most_);
    candidates_.resize(most_);
    const Candidate worst = *std::min_element(candidates_.begin(), candidates_.end());
    floor_ = score_of(worst) - 1;  // one as high may still have a lower row
  }

  // Choosing among a few more at once costs less than choosing more often.
  static constexpr std::size_t kSpare = 1024;

  std::size_t most_ = 1;
  std::int32_t floor_ = PackedCodes::kNoCode;
  std::vector<Candidate> candidates_;
};

// Who wants which list, sorted by list.
struct Wishes {
  std::vector<std::uint32_t> start;    // of each list in `queries`, and the end
  std::vector<std::uint32_t> queries;  // of the block
};

std::size_t share_of(double share, std::size_t count) {
  return static_cast<std::size_t>(share * static_cast<double>(count));
}

class CodedIndex : public DescriptorIndex {
 public:
  CodedIndex(std::span<const CodedPart> parts, const CodedSearchOptions& options)
      : options_(options) {
    std::vector<std::int8_t> centres;
    for (const CodedPart& part : parts) {
      const bool coded_only = part.values.empty();
      const std::size_t rows = coded_only ? part.codes->size() : part.values.size() / kShotLength;
      if (coded_only && rows > 0) compares_in_full_ = false;
      const std::string fault = fault_of_codes(*part.codes, rows);
      if (!fault.empty()) throw Error(ErrorCode::kInvalidArgument, "the index " + fault);
      if (rows >= kNoRow - size_) {
        throw Error(ErrorCode::kInvalidArgument, "stored descriptors are 2^32 - 1 or more");
      }
      add(part, centres);
    }
    list_start_.push_back(codes_.groups());
    centres_.append(centres);
    std::vector<std::int8_t> sample;
    for (std::size_t l = 0; l < lists(); l += kSampleStep) {
      const auto* centre = centres.data() + l * kCodeLength;
      sample.insert(sample.end(), centre, centre + kCodeLength);
    }
    sample_.append(sample);
  }

  std::size_t size() const override { return size_; }

  void search(std::span<const float> queries,
              std::size_t k,
              std::vector<DescriptorMatch>& out,
              const RunContext& context) const override {
    context.check(kStage);
    const std::vector<float> rows = normalise_rows(queries, Measure::kL2, "query descriptors");
    const std::size_t count = rows.size() / kShotLength;
    out.assign(count * k, {});
    if (count == 0 || k == 0 || size_ == 0) return;
    const RowCodes codes = code_rows(rows, context);
    parallel_chunks(count, context.threads, [&](std::size_t begin, std::size_t end) {
      for (; begin < end && !context.should_stop(); begin += kQueryBlock) {
        search_block({rows, codes, begin, std::min(begin + kQueryBlock, end)}, k, out, context);
      }
    });
    context.check(kStage);
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

  void add(const CodedPart& part, std::vector<std::int8_t>& centres) {
    const DescriptorCodes& codes = *part.codes;
    for (std::size_t l = 0; l < codes.lists(); ++l) {
      const std::size_t first = codes.list_start[l];
      const std::size_t count = codes.list_start[l + 1] - first;
      if (count == 0) continue;
      list_start_.push_back(codes_.groups());
      codes_.append(std::span(codes.codes).subspan(first * kCodeLength, count * kCodeLength));
      for (std::size_t i = 0; i < count; ++i) {
        row_of_.push_back(static_cast<std::uint32_t>(size_) + codes.rows[first + i]);
      }
      row_of_.resize(codes_.bias.size(), kNoRow);
      most_in_list_ = std::max(most_in_list_, count + kCodeGroup);
      const auto* centre = codes.centres.data() + l * kCodeLength;
      centres.insert(centres.end(), centre, centre + kCodeLength);
    }
    tails_.resize((size_ + codes.size()) * kCodeLength);
    for (std::size_t place = 0; place < codes.size(); ++place) {
      std::copy_n(codes.tails.data() + place * kCodeLength,
                  kCodeLength,
                  tails_.data() + (size_ + codes.rows[place]) * kCodeLength);
    }
    first_row_.push_back(size_);
    values_.push_back(part.values);
    size_ += codes.size();
  }

  std::size_t lists() const { return list_start_.size() - 1; }

  void search_block(const Block& block,
                    std::size_t k,
                    std::vector<DescriptorMatch>& out,
                    const RunContext& context) const {
    const std::size_t probes = std::min(
        lists(),
        std::max(options_.min_lists,
                 static_cast<std::size_t>(options_.list_share * static_cast<double>(lists()))));
    const std::size_t first = std::min(probes, kFirstLists);
    const auto compared = options_.compared + share_of(options_.compared_a_neighbour, k);
    const auto refined = options_.refined + share_of(options_.refined_a_neighbour, k);
    std::vector<std::uint32_t> chosen(block.size() * probes);
    choose_lists(block, probes, first, chosen);
    std::vector<Shortlist> shortlists(block.size());
    for (Shortlist& shortlist : shortlists) shortlist.reset(std::max({refined, compared, k}));
    read_lists(block, wishes_for(chosen, probes, 0, first), shortlists, context);
    read_lists(block, wishes_for(chosen, probes, first, probes), shortlists, context);
    for (std::size_t i = 0; i < block.size() && !context.should_stop(); ++i) {
      DescriptorMatch* found = out.data() + (block.begin + i) * k;
      if (compares_in_full_) {
        compare(block.row(i), refine(block.tail(i), shortlists[i].best(), compared), k, found);
      } else {
        rank(block.code(i), refine(block.tail(i), shortlists[i].best(), k), found);
      }
    }
  }

  // The `probes` lists of each query whose centres are nearest, the first `first` of them ahead.
  void choose_lists(const Block& block,
                    std::size_t probes,
                    std::size_t first,
                    std::vector<std::uint32_t>& chosen) const {
    std::vector<CodeHit> hits(centres_.bias.size());
    std::vector<std::int32_t> scores(sample_.bias.size());
    std::vector<Candidate> candidates;
    for (std::size_t i = 0; i < block.size(); ++i) {
      candidates.clear();
      for (std::int32_t floor : {likely_floor(block.code(i), probes, scores), kLowest}) {
        if (candidates.size() >= probes) break;
        candidates.clear();
        const std::size_t count = code_kernels().above(block.code(i),
                                                       centres_.bytes.data(),
                                                       centres_.bias.data(),
                                                       centres_.groups(),
                                                       floor,
                                                       hits.data());
        for (std::size_t h = 0; h < count; ++h) {
          if (hits[h].place < lists()) {
            candidates.push_back(make_candidate(hits[h].score, hits[h].place));
          }
        }
      }
      put_best_ahead(candidates, probes);
      put_best_ahead(std::span(candidates).first(probes), first);
      for (std::size_t j = 0; j < probes; ++j) chosen[i * probes + j] = row_of(candidates[j]);
    }
  }

  // A score above which the `probes` best lists probably lie, by a sample of them.
  std::int32_t likely_floor(const std::int8_t* code,
                            std::size_t probes,
                            std::vector<std::int32_t>& scores) const {
    constexpr std::size_t kSpare = 4;  // of the sample, lest too few are above
    const std::size_t rank = probes * 5 / 4 / kSampleStep + kSpare;
    const std::size_t sampled = (lists() + kSampleStep - 1) / kSampleStep;
    if (rank >= sampled) return kLowest;
    code_kernels().scores(
        code, sample_.bytes.data(), sample_.bias.data(), sample_.groups(), scores.data());
    const auto at = scores.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(scores.begin(), at, scores.end(), std::greater<>());
    return *at - 1;
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

  void read_lists(const Block& block,
                  const Wishes& wishes,
                  std::vector<Shortlist>& shortlists,
                  const RunContext& context) const {
    const CodeKernels& kernels = code_kernels();
    std::vector<CodeHit> hits(most_in_list_);
    for (std::size_t l = 0; l < lists() && !context.should_stop(); ++l) {
      const std::size_t group = list_start_[l];
      const std::uint32_t* rows = row_of_.data() + group * kCodeGroup;
      for (std::uint32_t w = wishes.start[l]; w < wishes.start[l + 1]; ++w) {
        Shortlist& shortlist = shortlists[wishes.queries[w]];
        const std::size_t count =
            kernels.above(block.code(wishes.queries[w]),
                          codes_.bytes.data() + group * kCodeGroup * kCodeLength,
                          codes_.bias.data() + group * kCodeGroup,
                          list_start_[l + 1] - group,
                          shortlist.floor(),
                          hits.data());
        for (std::size_t h = 0; h < count; ++h) {
          if (rows[hits[h].place] != kNoRow) {
            shortlist.offer(make_candidate(hits[h].score, rows[hits[h].place]));
          }
        }
      }
    }
  }

  // The best `most` of the candidates once their tails are counted in.
  std::span<Candidate> refine(const std::int8_t* tail,
                              std::span<Candidate> candidates,
                              std::size_t most) const {
    constexpr std::size_t kAhead = 16;
    const CodeKernels& kernels = code_kernels();
    const auto tail_of = [&](Candidate candidate) {
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
    put_best_ahead(candidates, most);
    return candidates.first(std::min(most, candidates.size()));
  }

  std::span<const float> values_of(std::size_t row) const {
    const auto above = std::upper_bound(first_row_.begin(), first_row_.end(), row);
    const auto part = static_cast<std::size_t>(above - first_row_.begin()) - 1;
    return descriptor_row(values_[part], row - first_row_[part]);
  }

  void compare(std::span<const float> query,
               std::span<const Candidate> candidates,
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
  static void rank(const std::int8_t* code, std::span<Candidate> candidates, DescriptorMatch* out) {
    constexpr std::int32_t kOffset = 2 * 128;  // see CodeKernels
    std::int32_t at_zero = 0;
    for (std::size_t j = 0; j < kCodeLength; ++j) at_zero += code[j] * (code[j] + kOffset);
    std::sort(candidates.begin(), candidates.end(), std::greater<>());
    for (const Candidate candidate : candidates) {
      const std::int32_t squared = std::max(at_zero - score_of(candidate), 0);
      *out++ = {row_of(candidate), dissimilarity_of_codes(squared)};
    }
  }

  CodedSearchOptions options_;
  bool compares_in_full_ = true;
  PackedCodes codes_;                    // each list begins a group
  std::vector<std::uint32_t> row_of_;    // by place in `codes_`; kNoRow: filling
  std::vector<std::int8_t> tails_;       // by row
  std::vector<std::size_t> list_start_;  // the first group of each list, and the number of groups
  PackedCodes sample_;                   // of every kSampleStep-th centre
  PackedCodes centres_;                  // of the lists
  std::vector<std::size_t> first_row_;   // of each part
  std::vector<std::span<const float>> values_;  // of each part
  std::size_t size_ = 0;
  std::size_t most_in_list_ = 0;
};

}  // namespace

std::unique_ptr<DescriptorIndex> make_coded_index(std::span<const CodedPart> parts,
                                                  const CodedSearchOptions& options) {
  return std::make_unique<CodedIndex>(parts, options);
}

}  // namespace landmarkdb
