// No include guard: plane_pairs.cpp includes this once for each instruction set, inside a namespace
// and under a target pragma. `Floats` and `Ints` are vectors of kLanes numbers that the compiler
// lowers to what the target has; the operations and their order are the same for all.

#include "engine/base/float_lanes_body.hpp"        // NOLINT(bugprone-suspicious-include): see there
#include "engine/registration/float_exp_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

LANDMARKDB_INLINE void store(float* p, Floats v) { __builtin_memcpy(p, &v, sizeof v); }

struct Met {
  Floats normal[3];  // of the plane near
  Floats point[3];   // target frame
  Floats distance;   // of the point from the plane
  Floats cosine;     // between the normals
};

// Rounded down, and clamped as SurfaceGrid::cell_on_axis does.
LANDMARKDB_INLINE Ints cells_on_axis(Floats scaled) {
  const Floats far = Floats{} + SurfaceGrid::kFarthestCell;
  const Floats low = scaled > -far ? scaled : -far;
  const Floats clamped = low < far ? low : far;
  const Ints cut = __builtin_convertvector(clamped, Ints);
  return cut + (__builtin_convertvector(cut, Floats) > clamped);  // true is -1
}

// The numbers of the surfels near, through the table of blocks.
LANDMARKDB_INLINE void find_in_table(const SurfaceGrid::TableView& view,
                                     const Floats* point,
                                     std::uint32_t* stored) {
  Ints index = {};
  Ints inner = {};
  Ints outside = {};
  for (int axis = 2; axis >= 0; --axis) {
    const Ints cell = cells_on_axis(point[axis] * view.inverse_cell);
    const Ints at = (cell >> SurfaceGrid::kBlockBits) - view.first[axis];
    const Ints off = (at < 0) | (at >= view.size[axis]);
    outside |= off;
    index = index * view.size[axis] + (at & ~off);  // what is off might not fit
    inner = (inner << SurfaceGrid::kBlockBits) | (cell & ((1 << SurfaceGrid::kBlockBits) - 1));
  }
  index = outside ? Ints{} : index + 1;
  std::int32_t entry[kLanes];
  std::int32_t cell[kLanes];
  __builtin_memcpy(entry, &index, sizeof entry);
  __builtin_memcpy(cell, &inner, sizeof cell);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    stored[lane] = view.cells[view.block_of[entry[lane]] * SurfaceGrid::kBlockCells +
                              static_cast<std::size_t>(cell[lane])];
  }
}

// The points and normals of eight surfels, x y z of each, lane by lane: the matrix of them, with
// two columns of nothing, turned about its diagonal.
LANDMARKDB_INLINE void load_surfels(const Surfel* surfels,
                                    const std::uint32_t* stored,
                                    Eights* numbers) {
  Eights row[8];
  for (int i = 0; i < 8; ++i) __builtin_memcpy(&row[i], surfels + stored[i], sizeof row[i]);
  Eights ones[8];  // of two rows by turns: numbers 0, 1, 4, 5, then 2, 3, 6, 7
  for (int i = 0; i < 8; i += 2) {
    ones[i] = __builtin_shufflevector(row[i], row[i + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    ones[i + 1] = __builtin_shufflevector(row[i], row[i + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  Eights fours[8];  // of four rows: numbers 0 and 4, 1 and 5, 2 and 6, 3 and 7
  for (int i = 0; i < 8; i += 4) {
    for (int k = 0; k < 2; ++k) {
      const Eights a = ones[i + k], b = ones[i + k + 2];
      fours[i + 2 * k] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
      fours[i + 2 * k + 1] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (int i = 0; i < 4; ++i) {
    numbers[i] = __builtin_shufflevector(fours[i], fours[i + 4], 0, 1, 2, 3, 8, 9, 10, 11);
  }
  for (int i = 0; i < 2; ++i) {
    numbers[i + 4] = __builtin_shufflevector(fours[i], fours[i + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

LANDMARKDB_INLINE Floats side_by_side(Eights low, Eights high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}

LANDMARKDB_INLINE Met meet(const SurfaceGrid& target,
                           const SurfaceGrid::TableView& view,
                           const float* group,
                           const PointMotion& motion) {
  const float* R = motion.R_target_source.data();  // column by column
  const float* t = motion.t_target_source.data();
  const Floats x = load(group), y = load(group + kLanes), z = load(group + 2 * kLanes);
  const Floats u = load(group + 3 * kLanes), v = load(group + 4 * kLanes),
               w = load(group + 5 * kLanes);
  Met met;
  Floats turned[3];
  for (int axis = 0; axis < 3; ++axis) {
    met.point[axis] = R[axis] * x + R[axis + 3] * y + R[axis + 6] * z + t[axis];
    turned[axis] = R[axis] * u + R[axis + 3] * v + R[axis + 6] * w;
  }
  std::uint32_t stored[kLanes];
  if (view.block_of != nullptr) {
    find_in_table(view, met.point, stored);
  } else {
    float p[3][kLanes];
    for (int axis = 0; axis < 3; ++axis) store(p[axis], met.point[axis]);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      stored[lane] = target.stored_at({p[0][lane], p[1][lane], p[2][lane]});
    }
  }
  Eights near[2][6];
  load_surfels(view.surfels, stored, near[0]);
  load_surfels(view.surfels, stored + 8, near[1]);
  met.distance = Floats{};
  met.cosine = Floats{};
  for (int axis = 0; axis < 3; ++axis) {
    met.normal[axis] = side_by_side(near[0][axis + 3], near[1][axis + 3]);
    met.distance +=
        met.normal[axis] * (met.point[axis] - side_by_side(near[0][axis], near[1][axis]));
    met.cosine += met.normal[axis] * turned[axis];
  }
  return met;
}

LANDMARKDB_INLINE Floats fit_of(const Met& met, float factor) {
  const Floats zero = {};
  const Floats agreement = met.cosine > zero ? met.cosine : zero;
  return agreement * exponential(factor * met.distance * met.distance);
}

void pair(const SurfaceGrid& target,
          const float* group,
          std::size_t groups,
          const PointMotion& motion,
          const PairOptions& options,
          float* values) {
  const SurfaceGrid::TableView view = target.table_view();
  const Floats zero = {};
  const Floats one = zero + 1.0F;
  const bool graded = options.factor == PairFactor::kGraded;
  for (std::size_t g = 0; g < groups; ++g) {
    const Met met = meet(target, view, group + g * kLanes * PointGroups::kNumbers, motion);
    for (int axis = 0; axis < 3; ++axis) {
      store(values, met.normal[axis]);
      store(values + 3 * kLanes, met.point[axis] - options.centre.data()[axis]);
      values += kLanes;
    }
    store(values + 3 * kLanes, met.distance);
    store(values + 4 * kLanes,
          graded ? (met.cosine > zero ? met.cosine : zero)
                 : (met.cosine >= options.min_agreement ? one : zero));
    values += 5 * kLanes;
  }
}

float mean_fit(const SurfaceGrid& target,
               const float* group,
               std::size_t groups,
               std::size_t points,
               const PointMotion& motion,
               const FitOptions& options) {
  const SurfaceGrid::TableView view = target.table_view();
  Floats sums = {};
  for (std::size_t g = 0; g < groups; ++g) {
    if (g == options.first_groups) {
      const float mean = add_up(sums) / static_cast<float>(g * kLanes);
      if (mean < options.hopeless) return mean - 1.0F;
    }
    const Met met = meet(target, view, group + g * kLanes * PointGroups::kNumbers, motion);
    sums += fit_of(met, options.factor);
  }
  return add_up(sums) / static_cast<float>(points);
}

void fits(const SurfaceGrid& target,
          const float* group,
          std::size_t groups,
          const PointMotion& motion,
          float factor,
          float* fits) {
  const SurfaceGrid::TableView view = target.table_view();
  for (std::size_t g = 0; g < groups; ++g) {
    const Met met = meet(target, view, group + g * kLanes * PointGroups::kNumbers, motion);
    store(fits + g * kLanes, fit_of(met, factor));
  }
}

constexpr PairKernels kKernels{pair, mean_fit, fits};

#undef LANDMARKDB_INLINE
