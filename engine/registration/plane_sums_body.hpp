// No include guard: plane_sums.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#define LANDMARKDB_INLINE [[gnu::always_inline]] inline

LANDMARKDB_INLINE Floats load(const float* p) {
  Floats v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

LANDMARKDB_INLINE float add_up(Floats v) {
  float lane[kLanes];
  __builtin_memcpy(lane, &v, sizeof v);
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) lane[i] += lane[i + width];
  }
  return lane[0];
}

// exp(x) for x <= 0 to 2e-7, relative: 2^y with y = x log2(e) in a whole and a part of -1/2 .. 1/2,
// the latter by its series.
LANDMARKDB_INLINE Floats exponential(Floats x) {
  const Floats lowest = Floats{} - 87.0F;  // below that, a float is denormal
  const Floats y = (x > lowest ? x : lowest) * 1.44269504F;
  const Ints whole = __builtin_convertvector(y - 0.5F, Ints);
  const Floats f = (y - __builtin_convertvector(whole, Floats)) * 0.693147181F;
  Floats p = f * (1.0F / 720.0F) + (1.0F / 120.0F);
  p = p * f + (1.0F / 24.0F);
  p = p * f + (1.0F / 6.0F);
  p = p * f + 0.5F;
  p = p * f + 1.0F;
  p = p * f + 1.0F;
  const Ints bits = (whole + 127) << 23;
  Floats power;
  __builtin_memcpy(&power, &bits, sizeof power);
  return p * power;
}

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
