#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb::datasets {

// What a beam of light does at a surface.
enum class Material {
  kOpaque,  // comes back
  kGlass,   // goes through and never comes back
};

// One thing of a place: a wall, a sofa, a lamp.
struct Object {
  std::string name;
  Material material = Material::kOpaque;
};

// Surfaces as triangles, metres, scene frame.
//
// Solids are closed and their triangles run counter-clockwise seen from the free side, so from
// anywhere a sensor may stand only front faces are seen. `object[i]` is what triangle i belongs to.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> object;  // as many as triangles; index into `objects`
  std::vector<Object> objects;
};

}  // namespace landmarkdb::datasets
