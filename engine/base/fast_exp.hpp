#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace landmarkdb {

// e^f for |f| <= log(2) / 2 to 3e-7, relative, by its series; of a number, or of a vector of them.
// Inlined, so that it is of the instruction set of its caller.
template <typename Real>
[[gnu::always_inline]] inline Real exp_by_series(Real f) {
  Real p = f * (1.0F / 720.0F) + (1.0F / 120.0F);
  p = p * f + (1.0F / 24.0F);
  p = p * f + (1.0F / 6.0F);
  p = p * f + 0.5F;
  p = p * f + 1.0F;
  p = p * f + 1.0F;
  return p;
}

// exp(x) for x <= 0 to 3e-7, relative; 1e-38 and less is given as 1e-38. 2^y with y = x log2(e) in
// a whole part and one of -1/2 .. 1/2, the latter by its series. A few nanoseconds, no branch; the
// same bytes on every machine.
inline float exp_of_negative(float x) {
  constexpr float kLowest = -87.0F;  // below that, a float is denormal
  constexpr float kLog2OfE = 1.44269504F;
  constexpr float kLogOf2 = 0.693147181F;
  const float y = std::max(x, kLowest) * kLog2OfE;
  const auto whole = static_cast<std::int32_t>(y - 0.5F);
  const float p = exp_by_series((y - static_cast<float>(whole)) * kLogOf2);
  constexpr std::int32_t kBias = 127;
  constexpr int kMantissaBits = 23;
  return p * std::bit_cast<float>((whole + kBias) << kMantissaBits);
}

}  // namespace landmarkdb
