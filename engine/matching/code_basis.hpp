#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine/types/descriptor_codes.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

inline constexpr std::size_t kCodeComponents = 2 * kCodeLength;  // of a code and its tail

// The principal components of SHOT, fitted once by landmarkdb-fit-basis on generated places and the
// same for every database: those of one place hold as much of the variance of others as their own
// do (92 %).
struct CodeBasis {
  // kCodeComponents x kShotLength, row-major: unit vectors, all in steps of one small length.
  std::vector<std::int16_t> components;
  std::array<std::int32_t, kCodeComponents> mean{};  // of the sums over rows in 1 / kRowSteps
  float step = 1.0F;                                 // of a code, in units of those sums
};

// What descriptor values are rounded to before the sums, which then are whole numbers.
inline constexpr float kRowSteps = 8192.0F;

const CodeBasis& code_basis();

}  // namespace landmarkdb
