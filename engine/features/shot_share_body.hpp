// No include guard: shot_share.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations are the same for all. Comparisons give -1 or 0.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

template <typename Vector, typename Number>
LANDMARKDB_INLINE void store(Number* p, Vector v) {
  __builtin_memcpy(p, &v, sizeof v);
}

LANDMARKDB_INLINE Floats all(float value) { return Floats{} + value; }
LANDMARKDB_INLINE Floats to_floats(Ints v) { return __builtin_convertvector(v, Floats); }
LANDMARKDB_INLINE Ints to_ints(Floats v) { return __builtin_convertvector(v, Ints); }
LANDMARKDB_INLINE Floats smaller(Floats a, Floats b) { return a < b ? a : b; }
LANDMARKDB_INLINE Floats larger(Floats a, Floats b) { return a > b ? a : b; }
LANDMARKDB_INLINE Floats size_of(Floats v) { return v < 0.0F ? -v : v; }

LANDMARKDB_INLINE Floats root(Floats v) {
  Floats result;
  for (std::size_t i = 0; i < kLanes; ++i) result[i] = __builtin_sqrtf(v[i]);
  return result;
}

// acos(c) for 0 <= c <= 1 to 2e-8 (Abramowitz and Stegun 4.4.46).
LANDMARKDB_INLINE Floats arc_cosine(Floats c) {
  Floats p = all(-0.0012624911F);
  p = p * c + 0.0066700901F;
  p = p * c - 0.0170881256F;
  p = p * c + 0.0308918810F;
  p = p * c - 0.0501743046F;
  p = p * c + 0.0889789874F;
  p = p * c - 0.2145988016F;
  p = p * c + 1.5707963050F;
  return root(1.0F - c) * p;
}

// atan(t) for 0 <= t <= 1 to 2e-8 (Abramowitz and Stegun 4.4.49).
LANDMARKDB_INLINE Floats arc_tangent(Floats t) {
  const Floats s = t * t;
  Floats p = all(0.0028662257F);
  p = p * s - 0.0161657367F;
  p = p * s + 0.0429096138F;
  p = p * s - 0.0752896400F;
  p = p * s + 0.1065626393F;
  p = p * s - 0.1420889944F;
  p = p * s + 0.1999355085F;
  p = p * s - 0.3333314528F;
  p = p * s + 1.0F;
  return t * p;
}

// A place along one of the four axes: the point's own bin, the neighbour it is shared with, and how
// large the neighbour's share is.
struct Along {
  Ints own, other;
  Floats weight;
};

// The cosine between normal and z axis, in bins from 0 to 10.
LANDMARKDB_INLINE Along along_cosine(Floats cosine) {
  const Floats clamped = smaller(larger(cosine, all(-1.0F)), all(1.0F));
  const Floats bin = (1.0F + clamped) * (static_cast<float>(kBins - 1) / 2.0F);
  const Ints own = to_ints(bin + 0.5F);
  const Floats past = bin - to_floats(own);
  // PCL counts the neighbour modulo 10: the one past 9 is 0.
  const Ints above = own + 1 >= kBins - 1 ? own + 1 - (kBins - 1) : own + 1;
  const Ints below = own < 1 ? own - 1 + (kBins - 1) : own - 1;
  return {own, past > 0.0F ? above : below, size_of(past)};
}

// The octant of the azimuth, counted from -pi, with PCL's choice on the borders. Within it the
// angle is taken from the nearer axis, 0 .. 1 of the octant, which runs the other way in every
// second one.
LANDMARKDB_INLINE Along along_azimuth(Floats x, Floats y) {
  const Floats size_x = size_of(x);
  const Floats size_y = size_of(y);
  const Ints left = (y > 0.0F) | ((y == 0.0F) & (x < 0.0F));
  const Ints forward = (x > 0.0F) | ((x == 0.0F) & (y > 0.0F));
  const Ints rising = (x * y > 0.0F) | (x == 0.0F);
  const Ints second = rising ? size_x < size_y : size_x > size_y;
  const Ints own = 4 * (left & 1) + 2 * ((left ^ forward) & 1) + (second & 1);
  const Floats longer = larger(size_x, size_y);
  const Floats angle = arc_tangent(smaller(size_x, size_y) / (longer > 0.0F ? longer : all(1.0F))) *
                       (2.0F / kQuarterTurn);
  const Floats past = second ? 0.5F - angle : angle - 0.5F;
  const Ints other = (past > 0.0F ? own + 1 : own + (kSectors - 1)) & (kSectors - 1);
  return {own, other, size_of(past)};
}

// The shell, inner 0 or outer 1. A point beyond the middle of its shell, as seen from the border
// between the two, has no neighbour there: its weight is negative.
struct Shell {
  Ints own;
  Floats weight;
};
LANDMARKDB_INLINE Shell along_radius(Floats distance, float radius) {
  const Ints outer = distance > radius / 2.0F;
  const Floats middle = outer ? all(0.75F * radius) : all(0.25F * radius);
  const Floats past = (distance - middle) / (radius / 2.0F);
  return {outer & 1, outer ? -past : past};
}

void share(const ShotPoints& points, std::size_t count, const ShotAxes& axes, ShotShares& shares) {
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Floats px = load(points.x + i);
    const Floats py = load(points.y + i);
    const Floats pz = load(points.z + i);
    const Floats x = px * axes.x[0] + py * axes.x[1] + pz * axes.x[2];
    const Floats y = px * axes.y[0] + py * axes.y[1] + pz * axes.y[2];
    const Floats z = px * axes.z[0] + py * axes.z[1] + pz * axes.z[2];
    const Floats distance = root(load(points.squared_m2 + i));
    const Floats cosine = load(points.nx + i) * axes.z[0] + load(points.ny + i) * axes.z[1] +
                          load(points.nz + i) * axes.z[2];

    const Along bin = along_cosine(cosine);
    const Along sector = along_azimuth(x, y);
    const Ints has_azimuth = (x != 0.0F) | (y != 0.0F);
    const Shell shell = along_radius(distance, axes.radius);
    // From the pole of the point's half, 0 .. 1 of the half; shared beyond its middle.
    const Ints upper = (z > 0.0F) & 1;
    const Floats past_half =
        arc_cosine(smaller(size_of(z) / distance, all(1.0F))) * (1.0F / kQuarterTurn) - 0.5F;

    const Ints volume = kPerSector * sector.own + 2 * shell.own + upper;
    const Ints other_volume = kPerSector * sector.other + 2 * shell.own + upper;
    store(shares.own + i, volume * kBins + bin.own);
    store(shares.cosine + i, volume * kBins + bin.other);
    store(shares.shell + i, (volume ^ 2) * kBins + bin.own);
    store(shares.elevation + i, (volume ^ 1) * kBins + bin.own);
    store(shares.azimuth + i, other_volume * kBins + bin.own);
    const Floats of_azimuth = has_azimuth ? sector.weight : all(0.0F);
    const Floats left_of_azimuth = has_azimuth ? 1.0F - sector.weight : all(0.0F);
    store(shares.own_weight + i,
          (1.0F - bin.weight) + (1.0F - size_of(shell.weight)) + (1.0F - size_of(past_half)) +
              left_of_azimuth);
    store(shares.cosine_weight + i, bin.weight);
    store(shares.shell_weight + i, larger(shell.weight, all(0.0F)));
    store(shares.elevation_weight + i, larger(past_half, all(0.0F)));
    store(shares.azimuth_weight + i, of_azimuth);
  }
}

#undef LANDMARKDB_INLINE
