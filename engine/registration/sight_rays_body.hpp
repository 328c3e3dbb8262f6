// No include guard: sight_rays.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

struct Triples {
  Floats x, y, z;
};

// `count` of them, three floats each; lanes beyond have the last one.
LANDMARKDB_INLINE Triples load_triples(const float* from, std::size_t count) {
  float lanes[3][kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    const float* at = from + 3 * (lane < count ? lane : count - 1);
    for (int axis = 0; axis < 3; ++axis) lanes[axis][lane] = at[axis];
  }
  return {load(lanes[0]), load(lanes[1]), load(lanes[2])};
}

LANDMARKDB_INLINE Triples turn(const Eigen::Matrix3f& rotation, const Triples& v) {
  const float* R = rotation.data();  // column by column
  return {R[0] * v.x + R[3] * v.y + R[6] * v.z,
          R[1] * v.x + R[4] * v.y + R[7] * v.z,
          R[2] * v.x + R[5] * v.y + R[8] * v.z};
}

LANDMARKDB_INLINE Floats size_of(Floats v) { return v < Floats{} ? -v : v; }

LANDMARKDB_INLINE Ints cells_along(Floats tangent, int side) {
  const Ints cell = __builtin_convertvector(along_face(tangent) * static_cast<float>(side), Ints);
  const Ints low = cell > 0 ? cell : Ints{};
  const Ints last = Ints{} + (side - 1);
  return low < last ? low : last;
}

// As RangeImage::place_of has it.
LANDMARKDB_INLINE Ints places_of(const Triples& ray, int side) {
  const Floats ax = size_of(ray.x), ay = size_of(ray.y), az = size_of(ray.z);
  const Ints on_x = (ax >= ay) & (ax >= az);
  const Ints on_y = ~on_x & (ay >= az);
  const Floats major = on_x ? ray.x : (on_y ? ray.y : ray.z);
  const Floats down = on_x ? ray.y : (on_y ? ray.z : ray.x);
  const Floats right = on_x ? ray.z : (on_y ? ray.x : ray.y);
  const Floats inverse = 1.0F / size_of(major);
  const Ints axis = on_x ? Ints{} : (on_y ? Ints{} + 2 : Ints{} + 4);
  const Ints face = axis + ((major < Floats{}) & 1);
  return (face << 24) | (cells_along(down * inverse, side) << 12) |
         cells_along(right * inverse, side);
}

void look(const float* points,
          const float* normals,
          std::size_t count,
          const SightView& view,
          SightRay* rays) {
  const float* t = view.t_view_surface.data();
  const float* cone = view.cone_axis.data();
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t lanes = count - first < kLanes ? count - first : kLanes;
    Triples ray = turn(view.R_view_surface, load_triples(points + 3 * first, lanes));
    ray = {ray.x + t[0], ray.y + t[1], ray.z + t[2]};
    const Floats squared = ray.x * ray.x + ray.y * ray.y + ray.z * ray.z;
    float range_of[kLanes];
    __builtin_memcpy(range_of, &squared, sizeof squared);
    for (float& value : range_of) value = std::sqrt(value);
    const Floats range = load(range_of);
    const Floats along = cone[0] * ray.x + cone[1] * ray.y + cone[2] * ray.z;
    const Ints seen =
        (range > Floats{}) & (range <= view.reach_m) & (along >= view.cone_cosine * range);
    const Ints place = places_of(ray, view.side);
    Ints back = {};
    if (normals != nullptr) {
      const Triples n = turn(view.R_view_surface, load_triples(normals + 3 * first, lanes));
      back = ray.x * n.x + ray.y * n.y + ray.z * n.z > Floats{};
    }
    const Floats shown = seen ? range : Floats{};
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      rays[first + lane] = {shown[lane], place[lane], back[lane]};
    }
  }
}

#undef LANDMARKDB_INLINE
