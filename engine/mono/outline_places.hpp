#pragma once

#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// A place on an edge of a model, metres, and the edge's direction, unit.
struct OutlinePlace {
  Eigen::Vector3d xyz, along;
};

// Some dozens, evenly along all edges; none where the edges have no length.
std::vector<OutlinePlace> outline_places(const MonoModel& model);

// Of each of them, which of model_views() see it from some radii away. Throws what `context.check`
// does.
std::vector<ViewMask> views_of_outline(const MonoModel& model, const RunContext& context = {});

}  // namespace landmarkdb
