#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "engine/matching/code_kernels.hpp"
#include "engine/types/descriptor_codes.hpp"

namespace landmarkdb {

// The codes of one entry's descriptors as an index reads them: packed for the kernels, list by
// list. Made by whoever reads the codes; indexes point into it.
struct CodedPart {
  static constexpr std::uint32_t kNoRow = std::numeric_limits<std::uint32_t>::max();

  std::size_t rows = 0;
  PackedCodes codes;                      // each list begins a group
  std::vector<std::uint32_t> row_of;      // by place in `codes`; kNoRow: filling
  std::vector<std::uint32_t> list_start;  // the first group of each list, and the number of groups
  std::vector<std::int8_t> centres;       // lists() x kCodeLength

  std::size_t lists() const { return list_start.empty() ? 0 : list_start.size() - 1; }
};

// Packs the codes of `rows` descriptors; lists without any are left out. Throws
// Error{kInvalidArgument} for codes that do not fit (fault_of_codes).
std::shared_ptr<const CodedPart> make_coded_part(const DescriptorCodes& codes, std::size_t rows);

// The tails, which lie by place, by row: rows x kCodeLength. The codes must fit.
std::vector<std::int8_t> tails_by_row(const DescriptorCodes& codes);

}  // namespace landmarkdb
