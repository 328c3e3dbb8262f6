#include "engine/matching/filters.hpp"

#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

void check_rows(std::span<const DescriptorMatch> matches, std::size_t k) {
  if (k == 0 || matches.size() % k != 0) {
    throw Error(ErrorCode::kInvalidArgument,
                std::to_string(matches.size()) + " matches are no whole number of rows of " +
                    std::to_string(k));
  }
}

Correspondence pair_of(std::size_t query, const DescriptorMatch& match) {
  return {static_cast<std::uint32_t>(query), match.index, match.distance};
}

}  // namespace

std::vector<Correspondence> nearest_pairs(std::span<const DescriptorMatch> matches, std::size_t k) {
  check_rows(matches, k);
  std::vector<Correspondence> pairs;
  for (std::size_t row = 0; row < matches.size() / k; ++row) {
    const DescriptorMatch& best = matches[row * k];
    if (best.index != DescriptorMatch::kNone) pairs.push_back(pair_of(row, best));
  }
  return pairs;
}

std::vector<Correspondence> filter_ratio(std::span<const DescriptorMatch> matches,
                                         std::size_t k,
                                         double ratio) {
  check_rows(matches, k);
  if (k < 2 || !(ratio > 0.0 && ratio <= 1.0)) {
    throw Error(ErrorCode::kInvalidArgument,
                "ratio filter has " + std::to_string(k) + " neighbours and a ratio of " +
                    std::to_string(ratio) + ", want at least 2 and a ratio above 0, at most 1");
  }
  std::vector<Correspondence> kept;
  for (std::size_t row = 0; row < matches.size() / k; ++row) {
    const DescriptorMatch& best = matches[row * k];
    const DescriptorMatch& second = matches[row * k + 1];
    if (best.index == DescriptorMatch::kNone) continue;
    // Without a second neighbour its distance is infinite.
    if (static_cast<double>(best.distance) < ratio * static_cast<double>(second.distance)) {
      kept.push_back(pair_of(row, best));
    }
  }
  return kept;
}

std::vector<Correspondence> filter_mutual(std::span<const DescriptorMatch> matches,
                                          std::size_t k,
                                          std::span<const DescriptorMatch> reverse,
                                          std::size_t k_reverse) {
  check_rows(reverse, k_reverse);
  std::vector<Correspondence> kept;
  for (const Correspondence& pair : nearest_pairs(matches, k)) {
    const std::size_t row = pair.target * k_reverse;
    if (row >= reverse.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "match names target " + std::to_string(pair.target) + " of " +
                      std::to_string(reverse.size() / k_reverse));
    }
    if (reverse[row].index == pair.query) kept.push_back(pair);
  }
  return kept;
}

}  // namespace landmarkdb
