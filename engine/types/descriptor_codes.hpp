#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace landmarkdb {

inline constexpr std::size_t kCodeLength = 64;  // one cache line

// Descriptors in short: each row's first 2 x kCodeLength principal components in 8 bits (see
// engine/matching/make_codes.hpp), sorted into lists of rows that are alike. A few lists, of these
// the codes, and of the best the tails tell which rows are worth comparing in full.
//
// `list_start` has one element more than there are lists; list l holds the places
// list_start[l] .. list_start[l + 1] - 1.
struct DescriptorCodes {
  std::vector<std::int8_t> centres;       // L x kCodeLength: the mean code of each list
  std::vector<std::uint32_t> list_start;  // L + 1, or empty where there are no rows
  std::vector<std::uint32_t> rows;        // N: the row whose code lies at each place
  std::vector<std::int8_t> codes;         // N x kCodeLength, by place: the first components
  std::vector<std::int8_t> tails;         // N x kCodeLength, by place: those that follow

  std::size_t size() const { return rows.size(); }
  std::size_t lists() const { return list_start.empty() ? 0 : list_start.size() - 1; }
};

}  // namespace landmarkdb
