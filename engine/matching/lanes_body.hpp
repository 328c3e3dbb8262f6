// No include guard: lanes.cpp includes this once for each instruction set, inside a namespace and
// under a target pragma. `Lanes` is a vector of 16 floats that the compiler lowers to what the
// target has; the operations and their order are the same for all.

[[gnu::always_inline]] inline Lanes load(const float* p) {
  Lanes v;
  __builtin_memcpy(&v, p, sizeof v);
  return v;
}

// What is left of an array past the last full 16, padded with zeros.
[[gnu::always_inline]] inline Lanes load_part(const float* p, std::size_t count) {
  Lanes v = {};
  __builtin_memcpy(&v, p, count * sizeof(float));
  return v;
}

[[gnu::always_inline]] inline float add_up(Lanes v) {
  float lane[kLanes];
  __builtin_memcpy(lane, &v, sizeof v);
  for (std::size_t width = kLanes / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) lane[i] += lane[i + width];
  }
  return lane[0];
}

[[gnu::always_inline]] inline Lanes squared_difference(Lanes a, Lanes b) {
  const Lanes d = a - b;
  return d * d;
}

[[gnu::always_inline]] inline Lanes absolute_difference(Lanes a, Lanes b) {
  const Lanes d = a - b;
  return d < 0.0F ? -d : d;
}

[[gnu::always_inline]] inline Lanes chi2_term(Lanes a, Lanes b) {
  const Lanes d = a - b;
  const Lanes s = a + b;
  const Lanes one = Lanes{} + 1.0F;
  return d * d / (s > 0.0F ? s : one);  // s = 0: a = b = 0, and the term is 0
}

[[gnu::always_inline]] inline Lanes smaller(Lanes a, Lanes b) { return a < b ? a : b; }

#define LANDMARKDB_LANE_SUM(name, term)                                         \
  float name(const float* a, const float* b, std::size_t n) {                   \
    Lanes sum = {};                                                             \
    std::size_t i = 0;                                                          \
    for (; i + kLanes <= n; i += kLanes) sum += term(load(a + i), load(b + i)); \
    if (i < n) sum += term(load_part(a + i, n - i), load_part(b + i, n - i));   \
    return add_up(sum);                                                         \
  }

LANDMARKDB_LANE_SUM(squared_l2, squared_difference)
LANDMARKDB_LANE_SUM(l1, absolute_difference)
LANDMARKDB_LANE_SUM(chi2, chi2_term)
LANDMARKDB_LANE_SUM(intersection, smaller)
#undef LANDMARKDB_LANE_SUM

constexpr LaneKernels kKernels{squared_l2, l1, chi2, intersection};
