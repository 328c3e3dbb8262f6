// No include guard: four_metric.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` is a vector of kLanes numbers that the compiler lowers to
// what the target has; the operations and their order are the same for all.

#define LANDMARKDB_INLINE [[gnu::always_inline]] inline

// sum of G's elements times the products.
LANDMARKDB_INLINE Floats weighed(const Floats* metric, const float* products) {
  return metric[0] * products[0] + metric[1] * products[1] + metric[2] * products[2] +
         metric[3] * products[3] + metric[4] * products[4] + metric[5] * products[5];
}

void mark(const float* const* metric,
          std::size_t count,
          const FourProducts& products,
          float bound,
          std::uint8_t* passes) {
  for (std::size_t at = 0; at < count; at += kLanes) {
    Floats G[6];
    for (std::size_t k = 0; k < 6; ++k) __builtin_memcpy(&G[k], metric[k] + at, sizeof G[k]);
    const Floats real = weighed(G, products.real.data());
    const Floats imaginary = weighed(G, products.imaginary.data());
    const Floats size = weighed(G, products.size.data());
    const Bytes passing =
        __builtin_convertvector(real * real + imaginary * imaginary < bound * size * size, Bytes);
    __builtin_memcpy(passes + at, &passing, sizeof passing);
  }
}

#undef LANDMARKDB_INLINE
