#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "engine/types/mono_model.hpp"

namespace landmarkdb {

struct OrientResult {
  std::size_t turned = 0;              // faces of solids that were wound inward
  bool open = false;                   // some part is not closed
  std::vector<std::string> crowded{};  // "4-7 (3 faces)": sides of more than two faces
};

// Winds the faces of each closed part so that they are counter-clockwise from outside; leaves the
// others as they are.
OrientResult orient_faces(MonoModel& model);

}  // namespace landmarkdb
