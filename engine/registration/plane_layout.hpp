#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb {

// Where the planes of a built place lie: three directions at right angles that most of its surface
// faces (floor and walls), and along each how much surface lies at which offset.
struct PlaneLayout {
  // Surface facing along one direction, by its offset along it.
  struct Offsets {
    float first_m = 0.0F;                     // offset at which the first bin begins
    std::array<std::vector<float>, 2> count;  // points a bin; facing the direction, and against it
    float total() const;
  };

  float bin_m = 0.0F;
  Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();  // columns, a right-handed frame
  std::array<Offsets, 3> offsets;                      // along each
  std::array<float, 3> low_m{}, high_m{};              // of all but stray points, along each
  std::size_t points = 0;
};

// The layouts of a thinned cloud (points in metres, unit normals turned to one side), at most
// `most`: the first direction is the same for all, the second ones are those that most surface
// faces, best first. Empty where too little of the surface faces any direction, or nothing faces
// across it. Deterministic. Cost: O(N).
std::vector<PlaneLayout> lay_out_planes(std::span<const Eigen::Vector3f> points,
                                        std::span<const Eigen::Vector3f> normals,
                                        double bin_m,
                                        std::size_t most);

}  // namespace landmarkdb
