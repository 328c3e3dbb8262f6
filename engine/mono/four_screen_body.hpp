// No include guard: four_screen.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` is a vector of kLanes numbers that the compiler lowers to
// what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

struct Vector {
  Floats x, y, z;
};

LANDMARKDB_INLINE Floats dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

LANDMARKDB_INLINE Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

LANDMARKDB_INLINE Floats root(Floats v) {
  float lane[kLanes];
  __builtin_memcpy(lane, &v, sizeof v);
  for (float& value : lane) value = std::sqrt(value);
  return load(lane);
}

// A row of the map: columns of the inverse weighed by one coordinate of the rays' differences.
LANDMARKDB_INLINE Vector mapped(const Vector* columns,
                                const float* rays,
                                const Floats* nearer,
                                std::size_t axis) {
  const Floats w0 = rays[2 + axis] * nearer[0] - rays[axis];
  const Floats w1 = rays[4 + axis] * nearer[1] - rays[axis];
  const Floats w2 = rays[6 + axis] * nearer[2] - rays[axis];
  return {columns[0].x * w0 + columns[1].x * w1 + columns[2].x * w2,
          columns[0].y * w0 + columns[1].y * w1 + columns[2].y * w2,
          columns[0].z * w0 + columns[1].z * w1 + columns[2].z * w2};
}

// `rays`: x and y of the four. `bound`: the square of what off may be of the inverse times the map.
void screen(const FourLanes& fours, const float* rays, float bound, std::uint8_t* passes) {
  Vector E[3], columns[3];  // rows of the differences, columns of their inverse
  for (std::size_t k = 0; k < 3; ++k) {
    E[k] = {load(fours.differences[3 * k].data()),
            load(fours.differences[3 * k + 1].data()),
            load(fours.differences[3 * k + 2].data())};
  }
  for (std::size_t k = 0; k < 3; ++k) columns[k] = cross(E[(k + 1) % 3], E[(k + 2) % 3]);
  const Floats inverse = 1.0F / dot(E[0], columns[0]);
  for (Vector& v : columns) v = {v.x * inverse, v.y * inverse, v.z * inverse};
  Floats nearer[3] = {Floats{} + 1.0F, Floats{} + 1.0F, Floats{} + 1.0F};
  Vector right = mapped(columns, rays, nearer, 0), down = mapped(columns, rays, nearer, 1);
  const Vector away = cross(right, down);
  const Floats scale = root(0.5F * (dot(right, right) + dot(down, down)) / dot(away, away));
  for (std::size_t k = 0; k < 3; ++k) nearer[k] += scale * dot(E[k], away);
  right = mapped(columns, rays, nearer, 0);
  down = mapped(columns, rays, nearer, 1);
  const Floats across = dot(right, right) - dot(down, down), twice = 2.0F * dot(right, down);
  Floats spread = {};
  for (const Vector& v : columns) {
    const Floats a = dot(v, right), b = dot(v, down);
    spread += a * a + b * b;
  }
  const Bytes passing =
      __builtin_convertvector(~(across * across + twice * twice > bound * spread), Bytes);
  __builtin_memcpy(passes, &passing, sizeof passing);
}

#undef LANDMARKDB_INLINE
