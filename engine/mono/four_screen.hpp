#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <Eigen/Core>

namespace landmarkdb {

// Fours of models that one four of the image may be, several at once.
struct FourLanes {
  static constexpr std::size_t kLanes = 16;

  // The differences of points 1, 2, 3 less point 0 (metres, object frame): row by row, x, y and z.
  std::array<std::array<float, kLanes>, 9> differences{};

  void set(std::size_t lane, const std::array<const Eigen::Vector3d*, 4>& points) {
    for (std::size_t k = 0; k < 9; ++k) {
      const auto axis = static_cast<Eigen::Index>(k % 3);
      const double difference = (*points[k / 3 + 1])[axis] - (*points[0])[axis];
      differences[k][lane] = static_cast<float>(difference);
    }
  }
};

// Sets passes[i] to 0 where the map from four i to `rays`, after one round of perspective
// correction (FourPose), is further from two orthogonal and equally long rows than `most_sigmas` of
// what noise of `sigma` makes of that, and clearly: numbers are of single precision, and all that
// are near the bound pass.
void screen_fours(const FourLanes& fours,
                  const std::array<Eigen::Vector2d, 4>& rays,
                  double most_sigmas,
                  double sigma,
                  std::array<std::uint8_t, FourLanes::kLanes>& passes);

// What screen_fours() runs on: `rays` are x and y of the four, `bound` the square of what their map
// may be off of the inverse times the map. By instruction set as four_kernel() has them.
using ScreenKernel = void (*)(const FourLanes& fours,
                              const float* rays,
                              float bound,
                              std::uint8_t* passes);
ScreenKernel screen_kernel(const char* instruction_set);

}  // namespace landmarkdb
