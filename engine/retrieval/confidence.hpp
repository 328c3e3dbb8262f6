#pragma once

#include "engine/registration/verify.hpp"

namespace landmarkdb {

// The chance that a pose is right (within 0.10 m and 5 deg): a logistic function of its quality, of
// how far the best different pose is behind (`margin`, 0..1), of the share of what is seen through,
// of the share of the query the entry covers and of how well the surface fixes the pose.
double confidence_of(const Evidence& evidence, double quality, double margin);

}  // namespace landmarkdb
