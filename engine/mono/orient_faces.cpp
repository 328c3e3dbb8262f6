#include "engine/mono/orient_faces.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include "engine/mono/model_faces.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

struct Use {
  std::uint32_t face = 0;
  bool forward = false;  // from the lower point to the higher
};
using Sides = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Use>>;

Sides sides_of(const MonoModel& model) {
  Sides sides;
  for (std::uint32_t f = 0; f < model.faces.size(); ++f) {
    const auto& face = model.faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i];
      const std::uint32_t b = face[(i + 1) % face.size()];
      sides[std::minmax(a, b)].push_back({f, a < b});
    }
  }
  return sides;
}

// Six times the volume between a face and `origin`.
double wedge(const MonoModel& model, std::size_t face, const Eigen::Vector3d& origin) {
  return area_vector(model, model.faces[face])
      .dot(model.points[model.faces[face].front()].xyz - origin);
}

}  // namespace

OrientResult orient_faces(MonoModel& model) {
  OrientResult result;
  const std::vector<bool> solid = solid_faces(model);
  result.open = std::find(solid.begin(), solid.end(), false) != solid.end();
  std::vector<std::vector<std::pair<std::uint32_t, bool>>> neighbours(model.faces.size());
  for (const auto& [side, uses] : sides_of(model)) {
    if (uses.size() > 2) {
      result.crowded.push_back(std::to_string(side.first) + "-" + std::to_string(side.second) +
                               " (" + std::to_string(uses.size()) + " faces)");
    }
    if (uses.size() != 2 || uses[0].face == uses[1].face) continue;
    // Two faces that agree run along their common side in opposite directions.
    const bool against = uses[0].forward == uses[1].forward;
    neighbours[uses[0].face].push_back({uses[1].face, against});
    neighbours[uses[1].face].push_back({uses[0].face, against});
  }
  std::vector<int> flipped(model.faces.size(), -1);  // -1: not reached
  for (std::uint32_t seed = 0; seed < model.faces.size(); ++seed) {
    if (!solid[seed] || flipped[seed] >= 0) continue;
    std::vector<std::uint32_t> part{seed};
    flipped[seed] = 0;
    for (std::size_t at = 0; at < part.size(); ++at) {
      for (const auto& [other, against] : neighbours[part[at]]) {
        if (flipped[other] >= 0) continue;
        flipped[other] = against ? 1 - flipped[part[at]] : flipped[part[at]];
        part.push_back(other);
      }
    }
    const Eigen::Vector3d& origin = model.points[model.faces[seed].front()].xyz;
    double volume = 0.0;
    for (const std::uint32_t f : part) {
      volume += wedge(model, f, origin) * (flipped[f] == 1 ? -1.0 : 1.0);
    }
    for (const std::uint32_t f : part) {
      if ((flipped[f] == 1) == (volume >= 0.0)) {
        std::reverse(model.faces[f].begin(), model.faces[f].end());
        ++result.turned;
      }
    }
  }
  return result;
}

}  // namespace landmarkdb
