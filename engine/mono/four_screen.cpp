#include "engine/mono/four_screen.hpp"

#include <cmath>
#include <numbers>

#include "engine/base/instruction_sets.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = FourLanes::kLanes;
typedef float Floats __attribute__((vector_size(kLanes * sizeof(float))));
typedef std::int8_t Bytes __attribute__((vector_size(kLanes)));

#define LANDMARKDB_KERNEL_BODY "engine/mono/four_screen_body.hpp"
#include "engine/base/instruction_sets_body.hpp"  // NOLINT(bugprone-suspicious-include): see there

constexpr KernelSets<ScreenKernel> kSets LANDMARKDB_KERNEL_SETS(screen);

}  // namespace

ScreenKernel screen_kernel(const char* instruction_set) { return kSets.named(instruction_set); }

void screen_fours(const FourLanes& fours,
                  const std::array<Eigen::Vector2d, 4>& rays,
                  double most_sigmas,
                  double sigma,
                  std::array<std::uint8_t, FourLanes::kLanes>& passes) {
  static const ScreenKernel screen = kSets.best();
  constexpr double kClearly = 1.05;  // single precision is off by less than a hundredth here
  std::array<float, 8> flat;
  for (std::size_t k = 0; k < rays.size(); ++k) {
    flat[2 * k] = static_cast<float>(rays[k].x());
    flat[2 * k + 1] = static_cast<float>(rays[k].y());
  }
  const double bound = kClearly * most_sigmas * 2.0 * std::numbers::sqrt2 * sigma;
  screen(fours, flat.data(), static_cast<float>(bound * bound), passes.data());
}

}  // namespace landmarkdb
