// No include guard: the bodies of kernels (instruction_sets_body.hpp) include this once for each
// instruction set, inside a namespace and under a target pragma, and undefine LANDMARKDB_INLINE at
// their ends. `Floats` and `Ints` are vectors of kLanes numbers that the compiler lowers to what
// the target has; the operations and their order are the same for all.

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

// exp_of_negative() of engine/base/fast_exp.hpp, sixteen at a time.
LANDMARKDB_INLINE Floats exponential(Floats x) {
  const Floats lowest = Floats{} - 87.0F;
  const Floats y = (x > lowest ? x : lowest) * 1.44269504F;
  const Ints whole = __builtin_convertvector(y - 0.5F, Ints);
  const Floats p =
      exp_by_series<Floats>((y - __builtin_convertvector(whole, Floats)) * 0.693147181F);
  const Ints bits = (whole + 127) << 23;
  Floats power;
  __builtin_memcpy(&power, &bits, sizeof power);
  return p * power;
}
