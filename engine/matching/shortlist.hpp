#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/put_largest_first.hpp"
#include "engine/matching/code_kernels.hpp"

namespace landmarkdb {

// A score and a row (or list) as one number: more is better, the lower row of two with one score.
using CodeCandidate = std::uint64_t;

inline CodeCandidate make_candidate(std::int32_t score, std::uint32_t row) {
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31U;
  return static_cast<CodeCandidate>(static_cast<std::uint32_t>(score) ^ kSign) << 32U | ~row;
}
inline std::int32_t score_of(CodeCandidate candidate) {
  constexpr std::uint32_t kSign = std::uint32_t{1} << 31U;
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(candidate >> 32U) ^ kSign);
}
inline std::uint32_t row_of(CodeCandidate candidate) {
  return ~static_cast<std::uint32_t>(candidate);
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
  void offer(CodeCandidate candidate) {
    candidates_.push_back(candidate);
    if (candidates_.size() >= most_ + std::max(most_, kSpare)) prune();
  }
  // The best, in no order, for the caller to change.
  std::span<CodeCandidate> best() {
    if (candidates_.size() > most_) prune();
    return candidates_;
  }

 private:
  void prune() {
    put_largest_first(candidates_, most_);
    candidates_.resize(most_);
    const CodeCandidate worst = *std::min_element(candidates_.begin(), candidates_.end());
    floor_ = score_of(worst) - 1;  // one as high may still have a lower row
  }

  // Choosing among a few more at once costs less than choosing more often.
  static constexpr std::size_t kSpare = 1024;

  std::size_t most_ = 1;
  std::int32_t floor_ = PackedCodes::kNoCode;
  std::vector<CodeCandidate> candidates_;
};

}  // namespace landmarkdb
