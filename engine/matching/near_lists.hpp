#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/matching/code_kernels.hpp"
#include "engine/matching/shortlist.hpp"

namespace landmarkdb {

// The mean codes of a coded index's lists, and which of them are nearest to a code.
class NearLists {
 public:
  // Memory that is used again from code to code; of one thread.
  struct Scratch {
    CodeHits hits;
    std::vector<std::int32_t> scores;
    std::vector<CodeCandidate> candidates;
  };

  // The next list's, kCodeLength numbers.
  void add(std::span<const std::int8_t> centre);
  // Once, after the last.
  void finish();

  std::size_t size() const { return lists_; }

  // The numbers of the lists nearest to a code, as many as there is room for in `chosen` (no more
  // than there are), the `first` nearest of them ahead.
  void choose(const std::int8_t* code,
              std::size_t first,
              std::span<std::uint32_t> chosen,
              Scratch& scratch) const;

 private:
  std::int32_t likely_floor(const std::int8_t* code,
                            std::size_t wanted,
                            std::vector<std::int32_t>& scores) const;

  std::size_t lists_ = 0;
  std::vector<std::int8_t> added_;  // until they are packed
  PackedCodes centres_;
  PackedCodes sample_;  // of every kSampleStep-th centre
};

}  // namespace landmarkdb
