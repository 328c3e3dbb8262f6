#include "engine/matching/near_lists.hpp"

#include <algorithm>
#include <functional>

#include "engine/base/put_largest_first.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kSampleStep = 16;
constexpr std::int32_t kLowest = PackedCodes::kNoCode;

}  // namespace

void NearLists::add(std::span<const std::int8_t> centre) {
  added_.insert(added_.end(), centre.begin(), centre.end());
  ++lists_;
}

void NearLists::finish() {
  centres_.append(added_);
  std::vector<std::int8_t> sample;
  for (std::size_t l = 0; l < lists_; l += kSampleStep) {
    const auto* centre = added_.data() + l * kCodeLength;
    sample.insert(sample.end(), centre, centre + kCodeLength);
  }
  sample_.append(sample);
  added_ = {};
}

void NearLists::choose(const std::int8_t* code,
                       std::size_t first,
                       std::span<std::uint32_t> chosen,
                       Scratch& scratch) const {
  const std::size_t wanted = chosen.size();
  std::vector<CodeCandidate>& candidates = scratch.candidates;
  candidates.clear();
  scratch.hits.make_room(centres_.bias.size());
  for (const std::int32_t floor : {likely_floor(code, wanted, scratch.scores), kLowest}) {
    if (candidates.size() >= wanted) break;
    candidates.clear();
    const std::size_t count = code_kernels().above(code,
                                                   centres_.bytes.data(),
                                                   centres_.bias.data(),
                                                   centres_.groups(),
                                                   floor,
                                                   scratch.hits.scores.data(),
                                                   scratch.hits.places.data());
    for (std::size_t h = 0; h < count; ++h) {
      const std::uint32_t list = scratch.hits.places[h];
      if (list < lists_) candidates.push_back(make_candidate(scratch.hits.scores[h], list));
    }
  }
  put_largest_first(candidates, wanted);
  put_largest_first(std::span(candidates).first(wanted), first);
  for (std::size_t j = 0; j < wanted; ++j) chosen[j] = row_of(candidates[j]);
}

// A score above which the best lists that are wanted probably lie, by a sample of all.
std::int32_t NearLists::likely_floor(const std::int8_t* code,
                                     std::size_t wanted,
                                     std::vector<std::int32_t>& scores) const {
  constexpr std::size_t kSpare = 4;  // of the sample, lest too few are above
  const std::size_t rank = wanted * 5 / 4 / kSampleStep + kSpare;
  const std::size_t sampled = (lists_ + kSampleStep - 1) / kSampleStep;
  if (rank >= sampled) return kLowest;
  scores.resize(sample_.bias.size());
  code_kernels().scores(
      code, sample_.bytes.data(), sample_.bias.data(), sample_.groups(), scores.data());
  const auto at = scores.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(scores.begin(), at, scores.end(), std::greater<>());
  return *at - 1;
}

}  // namespace landmarkdb
