#pragma once

#include "engine/registration/verify.hpp"

namespace landmarkdb {

// The chance that a pose is right (within 0.10 m and 5 deg): a logistic function of how far the
// best different pose is behind (`margin`, 0..1), of the contrast to it, of how well the surface
// fixes the pose, of what sensor and scanner saw against it, and of the descriptors that agree. Of
// an object: object_confidence.hpp.
double confidence_of(const Evidence& evidence, double quality, double margin);

// What the pose would be believed at by its own evidence, were no other known: with rivals, what
// makes the answer ambiguous and not wrong.
double confidence_alone(const Evidence& evidence, double quality);

}  // namespace landmarkdb
