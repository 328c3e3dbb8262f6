#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "engine/cloud/input.hpp"
#include "engine/cloud/mesh.hpp"

namespace landmarkdb {

// A mesh as flat pieces: neighbouring polygons that lie in one plane are one region.
struct MeshRegions {
  struct Region {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    // Closed outlines of vertices, counter-clockwise seen from outside, holes clockwise; the one
    // with the largest area first.
    std::vector<std::vector<std::uint32_t>> outlines{};
  };
  // Where regions meet, by its two vertices (the lower first).
  struct Side {
    std::vector<std::uint32_t> regions{};
    bool sharp = false;  // an edge to be seen: a border, or a bend of 20 degrees or more
  };
  std::vector<Eigen::Vector3d> vertices{};  // each place once, file units
  std::vector<Region> regions{};
  std::map<std::pair<std::uint32_t, std::uint32_t>, Side> sides{};
  double extent = 0.0;  // diagonal of the bounding box, file units
};

// Cost: O(n log n) in polygons. Throws Error{kInvalidArgument} for coordinates that are not finite
// and for meshes without area; what the input's context throws.
MeshRegions find_regions(const Input& input, const Mesh& mesh);

}  // namespace landmarkdb
