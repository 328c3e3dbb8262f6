#pragma once

#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace landmarkdb {

// What a range image sees of the world: a cone about its viewpoint, the sphere cut into the six
// faces of a cube, `side` cells along the edge of each.
struct SightView {
  Eigen::Matrix3f R_view_surface = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t_view_surface = Eigen::Vector3f::Zero();  // to the viewpoint, metres
  Eigen::Vector3f cone_axis = Eigen::Vector3f::UnitZ();
  float cone_cosine = -1.0F;
  float reach_m = 0.0F;
  int side = 0;  // below 4096
};

// Where one point of a surface is seen.
struct SightRay {
  float range_m = 0.0F;  // 0: it is not in view
  // The face (2 axis + 1 where negative), row and column of its cell: face << 24 | row << 12 |
  // column.
  std::int32_t place = 0;
  std::int32_t back = 0;  // not 0: seen from behind
};

// Of `count` points, three floats each, with normals as many or null. All give the same bytes.
using SightKernel = void (*)(const float* points,
                             const float* normals,
                             std::size_t count,
                             const SightView& view,
                             SightRay* rays);

// The best this machine has.
SightKernel sight_kernel();

// That of one instruction set by name, "sse2", "avx2" or "avx512", for the test that all agree;
// null where the machine lacks it.
SightKernel sight_kernel(const char* instruction_set);

}  // namespace landmarkdb
