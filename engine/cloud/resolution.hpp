#pragma once

#include "engine/base/run_context.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// What a cloud's own points say about its size and density.
struct CloudScale {
  double extent_m =
      0.0;  // diagonal of the box that holds the middle 98 % of the points on each axis
  double spacing_m =
      0.0;  // typical distance between neighbours, each piece of surface counted once
};

// Measures a sanitised cloud, each point by its weight. Deterministic; looks at no more than a
// fixed number of points. Throws Error{kInvalidArgument} for fewer than 4 points, and what
// `context.check` does.
CloudScale measure_scale(const PointCloud& cloud, const RunContext& context = {});

// Its extent alone; 0 for a cloud without points.
double measure_extent(const PointCloud& cloud, const RunContext& context = {});

// True when the extent suggests that the units are not metres (a room of 3,000 m or of 3 mm, by
// kind).
bool units_look_wrong(const CloudScale& scale, EntryKind kind);

}  // namespace landmarkdb
