#pragma once

#include "engine/registration/verify.hpp"

namespace landmarkdb {

// The chance that a pose is right (within 0.10 m and 5 deg): a logistic function of how far the
// best different pose is behind (`margin`, 0..1), of the contrast to it, of how well the surface
// fixes the pose, of what the sensor should have seen and did, and of the descriptors that agree;
// of an object's, of its quality instead of the last.
double confidence_of(const Evidence& evidence, double quality, double margin);

// What the pose would be believed at by its own evidence, were no other known: with rivals, what
// makes the answer ambiguous and not wrong.
double confidence_alone(const Evidence& evidence, double quality);

}  // namespace landmarkdb
