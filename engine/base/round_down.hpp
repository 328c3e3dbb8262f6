#pragma once

namespace landmarkdb {

// The largest whole number not above `value`, which must fit. Without a call to std::floor, which
// SSE2 has no instruction for.
template <typename Whole, typename Real>
Whole round_down(Real value) {
  const auto cut = static_cast<Whole>(value);
  return cut - (static_cast<Real>(cut) > value ? 1 : 0);
}

}  // namespace landmarkdb
