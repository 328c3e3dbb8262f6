#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/descriptor_codes.hpp"

namespace landmarkdb {

// The code and the tail of each row, N x kCodeLength each.
struct RowCodes {
  std::vector<std::int8_t> codes, tails;
};

// The principal components of each row in 8 bits (code_basis.hpp). `values` is N x kShotLength,
// rows of unit length, numbers from 0 to 1. The same bytes on every machine and for any
// `context.threads`. Throws what `context.check` does.
RowCodes code_rows(std::span<const float> values, const RunContext& context);

// Codes in lists of about 64 that are alike (Lloyd's k-means on whole numbers, from rows spread
// evenly over `values`). For descriptors of one entry, made when it is indexed and stored with it:
// lists of several entries are searched together as they are. The same bytes on every machine and
// for any `context.threads`. Throws like code_rows. Cost: N^2 / 64 comparisons of codes a round.
DescriptorCodes make_codes(std::span<const float> values, const RunContext& context);

// The same codes in lists of consecutive rows, for an index of which every list is read: a small
// part of the work. The same bytes on every machine and for any `context.threads`. Throws like
// code_rows.
DescriptorCodes make_codes_in_order(std::span<const float> values, const RunContext& context);

// The dissimilarity in terms of Measure::kL2 for the squared distance of two codes with their
// tails.
float dissimilarity_of_codes(std::int32_t squared_distance);

// What is wrong with codes for `rows` descriptors: they come from a file. Empty: nothing.
std::string fault_of_codes(const DescriptorCodes& codes, std::size_t rows);

}  // namespace landmarkdb
