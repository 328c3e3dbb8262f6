#pragma once

#include "engine/servo/task.hpp"
#include "engine/types/mono_model.hpp"

namespace landmarkdb {

// The symmetry of a model as far as an arm may use it: "cN" and "revolution" about the z axis of
// the object frame. Of any other, or about another axis, none: the arm then undoes every turn.
ServoSymmetry servo_symmetry_of(const MonoModel& model);

}  // namespace landmarkdb
