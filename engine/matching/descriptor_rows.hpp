#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "engine/types/features.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb {

// Rows of kShotLength, normalised for `measure` (see measures.hpp). Throws Error{kInvalidArgument}
// that begins with `name` when `values` is no whole number of rows or holds a number that is
// negative or not finite.
std::vector<float> normalise_rows(std::span<const float> values,
                                  Measure measure,
                                  std::string_view name);

inline std::span<const float> descriptor_row(std::span<const float> rows, std::size_t i) {
  return rows.subspan(i * kShotLength, kShotLength);
}

}  // namespace landmarkdb
