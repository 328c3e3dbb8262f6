// No include guard: plane_sums_body.hpp and plane_pairs_body.hpp include this once for each
// instruction set, after engine/base/float_lanes_body.hpp. `Ints` are as many numbers as `Floats`.

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
