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

// The distance of the nearest neighbour of `row` that stands apart from its first.
float rival_distance(std::span<const DescriptorMatch> row, const RatioRivals& rivals) {
  if (rivals.target.empty()) return row[1].distance;
  for (const DescriptorMatch& match : row) {
    if (match.index != DescriptorMatch::kNone && match.index >= rivals.target.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "match names target " + std::to_string(match.index) + " of " +
                      std::to_string(rivals.target.size()));
    }
  }
  const Eigen::Vector3f& best = rivals.target[row[0].index];
  for (const DescriptorMatch& match : row.subspan(1)) {
    if (match.index == DescriptorMatch::kNone) return match.distance;  // infinite: no rival left
    if (static_cast<double>((rivals.target[match.index] - best).norm()) > rivals.apart_m) {
      return match.distance;
    }
  }
  return row.back().distance;
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
                                         double ratio,
                                         const RatioRivals& rivals) {
  check_rows(matches, k);
  if (k < 2 || !(ratio > 0.0 && ratio <= 1.0)) {
    throw Error(ErrorCode::kInvalidArgument,
                "ratio filter has " + std::to_string(k) + " neighbours and a ratio of " +
                    std::to_string(ratio) + ", want at least 2 and a ratio above 0, at most 1");
  }
  std::vector<Correspondence> kept;
  for (std::size_t row = 0; row < matches.size() / k; ++row) {
    const DescriptorMatch& best = matches[row * k];
    if (best.index == DescriptorMatch::kNone) continue;
    const float rival = rival_distance(matches.subspan(row * k, k), rivals);
    if (static_cast<double>(best.distance) < ratio * static_cast<double>(rival)) {
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
