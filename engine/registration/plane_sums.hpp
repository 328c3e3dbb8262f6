#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <Eigen/Core>

namespace landmarkdb {

// The normal equations A x = b of one step of point-to-plane alignment (Chen and Medioni 1992) in
// (translation, rotation about a centre), and what goes with them: J = [n, p x n],
// A = sum w J J^T, b = -sum w d J.
struct PlaneSums {
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
  double weight = 0.0;
  double squared_m2 = 0.0;  // sum w d^2
  std::size_t pairs = 0;
};

// How a pair's weight falls with its distance d, besides the factor it is added with.
enum class PairWeight {
  kGemanMcClure,  // 1 / (1 + d^2 / scale^2)^2 (Geman and McClure 1987)
  kGaussian,      // exp(-d^2 / (2 scale^2))
};

// Collects pairs of a point and a plane and adds them up, in single precision over 16 fixed lanes
// and in double from some hundred pairs to the next: the same bytes on every machine.
class PlaneSummer {
 public:
  // `scale_m` > 0.
  PlaneSummer(PairWeight weight, double scale_m);

  // `normal`: the plane's, of unit length. `from_centre`: the point from the centre, metres, target
  // frame. `distance_m`: of the point from the plane, signed. `factor`: of the pair's weight.
  void add(const Eigen::Vector3f& normal,
           const Eigen::Vector3f& from_centre,
           float distance_m,
           float factor) {
    const std::size_t lane = held_ % kLanes;
    float* group = values_.data() + (held_ - lane) * kNumbers;
    if (lane == 0) std::fill_n(group, kLanes * kNumbers, 0.0F);  // what stays empty counts nothing
    const float numbers[kNumbers] = {normal.x(),
                                     normal.y(),
                                     normal.z(),
                                     from_centre.x(),
                                     from_centre.y(),
                                     from_centre.z(),
                                     distance_m,
                                     factor};
    for (std::size_t k = 0; k < kNumbers; ++k) group[k * kLanes + lane] = numbers[k];
    sums_.pairs += factor > 0.0F ? 1U : 0U;
    if (++held_ == kHeld) flush();
  }

  // The sums of all pairs added so far.
  const PlaneSums& finish();

  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kNumbers = 8;  // of a pair

 private:
  static constexpr std::size_t kHeld = 256;

  void flush();

  PairWeight weight_;
  float factor_;  // of d^2
  std::size_t held_ = 0;
  PlaneSums sums_;
  std::array<float, kHeld * kNumbers> values_;  // groups of 16 pairs, 16 of each number
};

// What the lanes add up: the lower triangle of A row by row, sum w d J, sum w, sum w d^2.
inline constexpr std::size_t kPlaneTerms = 21 + 6 + 2;

// Adds up `groups` groups of pairs as PlaneSummer holds them into `sums` (kPlaneTerms).
using PlaneKernel =
    void (*)(const float* values, std::size_t groups, PairWeight weight, float factor, float* sums);

// The kernel of one instruction set by name, "sse2", "avx2" or "avx512", for the test that all
// agree; null where the machine lacks it.
PlaneKernel plane_kernel(const char* instruction_set);

}  // namespace landmarkdb
