// No include guard: plane_sums.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"        // NOLINT(bugprone-suspicious-include): see there
#include "engine/registration/float_exp_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

LANDMARKDB_INLINE Floats weight_of(PairWeight weight, Floats squared, float factor) {
  if (weight == PairWeight::kGaussian) return exponential(squared * factor);
  const Floats one = Floats{} + 1.0F;
  const Floats root = one + squared * factor;
  return one / (root * root);
}

void add_planes(
    const float* values, std::size_t groups, PairWeight weight, float factor, float* sums) {
  Floats A[21] = {};
  Floats b[6] = {};
  Floats weights = {};
  Floats squares = {};
  for (std::size_t group = 0; group < groups; ++group) {
    const float* at = values + group * kLanes * kNumbers;
    const Floats n[3] = {load(at), load(at + kLanes), load(at + 2 * kLanes)};
    const Floats p[3] = {load(at + 3 * kLanes), load(at + 4 * kLanes), load(at + 5 * kLanes)};
    const Floats d = load(at + 6 * kLanes);
    const Floats squared = d * d;
    const Floats w = load(at + 7 * kLanes) * weight_of(weight, squared, factor);
    const Floats J[6] = {n[0],
                         n[1],
                         n[2],
                         p[1] * n[2] - p[2] * n[1],
                         p[2] * n[0] - p[0] * n[2],
                         p[0] * n[1] - p[1] * n[0]};
    std::size_t term = 0;
    for (std::size_t row = 0; row < 6; ++row) {
      const Floats wJ = w * J[row];
      for (std::size_t column = 0; column <= row; ++column) A[term++] += wJ * J[column];
      b[row] += wJ * d;
    }
    weights += w;
    squares += w * squared;
  }
  for (std::size_t term = 0; term < 21; ++term) sums[term] = add_up(A[term]);
  for (std::size_t row = 0; row < 6; ++row) sums[21 + row] = add_up(b[row]);
  sums[27] = add_up(weights);
  sums[28] = add_up(squares);
}

#undef LANDMARKDB_INLINE
