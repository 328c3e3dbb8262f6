// No include guard: the bodies of kernels (instruction_sets_body.hpp) include this once for each
// instruction set, inside a namespace and under a target pragma, and undefine LANDMARKDB_INLINE at
// their ends. `Floats` is a vector of kLanes numbers that the compiler lowers to what the target
// has; the operations and their order are the same for all.

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
