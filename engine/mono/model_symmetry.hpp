#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// The rotations (never mirrors) that map a model's points with their types and normals, its edges,
// faces and circles onto themselves within a thousandth of the diameter: what an image of 600
// pixels across the object cannot tell apart. Identity first, then by angle; a body of revolution
// has only the finite ones of its axis: none, or the half turn that swaps its ends. Points that all
// lie on one line otherwise: identity alone.
std::vector<Eigen::Matrix4d> derive_symmetries(const MonoModel& model, const RunContext& context);

// How far from any point of its type the worst point lies once moved by `T`, metres.
double symmetry_error_m(const MonoModel& model, const Eigen::Matrix4d& T);

// All that a model has is circles round one axis.
bool is_revolution(const MonoModel& model);

// The name of the group of `model.symmetries`: "none", "c2" ... of one axis, "d2" ... of an axis
// and half turns across it, "tetrahedron" (12), "cube" (24), "icosahedron" (60), "revolution" for
// is_revolution, "other" for a list that is no such group.
std::string symmetry_class(const MonoModel& model);

}  // namespace landmarkdb
