// No include guard: moment_sums.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

Moments add_moments(const float* x,
                    const float* y,
                    const float* z,
                    std::size_t count,
                    const float* centre,
                    float squared_m2) {
  const Floats none = {};
  Floats counted = {};
  Floats sum[3] = {};
  Floats products[6] = {};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats dx = load(x + i) - centre[0];
    const Floats dy = load(y + i) - centre[1];
    const Floats dz = load(z + i) - centre[2];
    const Ints near = dx * dx + dy * dy + dz * dz < squared_m2;
    const Floats px = near ? dx : none;
    const Floats py = near ? dy : none;
    const Floats pz = near ? dz : none;
    counted += near ? none + 1.0F : none;
    sum[0] += px;
    sum[1] += py;
    sum[2] += pz;
    products[0] += px * px;
    products[1] += px * py;
    products[2] += px * pz;
    products[3] += py * py;
    products[4] += py * pz;
    products[5] += pz * pz;
  }
  Moments moments;
  moments.count = add_up(counted);
  for (std::size_t k = 0; k < 3; ++k) moments.sum[k] = add_up(sum[k]);
  for (std::size_t k = 0; k < 6; ++k) moments.products[k] = add_up(products[k]);
  return moments;
}

#undef LANDMARKDB_INLINE
