#include "engine/matching/shortlist.hpp"

#include <array>
#include <functional>

namespace landmarkdb {

namespace {

// The candidate in the middle of a few spread over the range.
CodeCandidate middle_of(std::span<const CodeCandidate> range) {
  constexpr std::size_t kSampled = 9;
  std::array<CodeCandidate, kSampled> sample{};
  for (std::size_t i = 0; i < kSampled; ++i)
    sample[i] = range[i * (range.size() - 1) / (kSampled - 1)];
  std::nth_element(sample.begin(), sample.begin() + kSampled / 2, sample.end());
  return sample[kSampled / 2];
}

// Those above `pivot` ahead of the others; how many there are. Without a branch on what they are,
// of which half would be mispredicted.
std::size_t part(std::span<CodeCandidate> range, CodeCandidate pivot) {
  std::size_t above = 0;
  for (CodeCandidate& candidate : range) {
    const CodeCandidate here = candidate;
    candidate = range[above];
    range[above] = here;
    above += here > pivot ? 1U : 0U;
  }
  return above;
}

}  // namespace

void put_best_ahead(std::span<CodeCandidate> candidates, std::size_t most) {
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

}  // namespace landmarkdb
