#pragma once

#include "engine/registration/verify.hpp"

namespace landmarkdb {

// Log-odds that an object's pose is right: how far the best rival at that spot is behind (`margin`,
// 0..1), its quality, the descriptors that agree, what is contradicted in an area, and where it is
// outgrown.
double object_log_odds(const Evidence& evidence, double quality, double margin);

// The same were no rival known.
double object_log_odds_alone(const Evidence& evidence, double quality);

}  // namespace landmarkdb
