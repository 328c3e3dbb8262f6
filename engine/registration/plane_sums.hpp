#pragma once

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

// Adds pairs of a point and a plane up, in single precision over 16 fixed lanes and in double from
// some hundred pairs to the next: the same bytes on every machine.
class PlaneSummer {
 public:
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kNumbers = 8;      // of a pair
  static constexpr std::size_t kMostGroups = 16;  // that are added in single precision
  using Values = std::array<float, kMostGroups * kLanes * kNumbers>;

  // `scale_m` > 0.
  PlaneSummer(PairWeight weight, double scale_m);

  // Groups of 16 pairs: the x of the planes' unit normals, y, z; those of the points from the
  // centre, metres, target frame; their signed distances from the planes, metres; a factor of each
  // pair's weight, 0 of what counts nothing. At most kMostGroups.
  void add(const float* values, std::size_t groups);

  const PlaneSums& sums() const { return sums_; }

 private:
  PairWeight weight_;
  float factor_;  // of d^2
  PlaneSums sums_;
};

// What the lanes add up: the lower triangle of A row by row, sum w d J, sum w, sum w d^2.
inline constexpr std::size_t kPlaneTerms = 21 + 6 + 2;

// Adds up `groups` groups of pairs as PlaneSummer takes them into `sums` (kPlaneTerms).
using PlaneKernel =
    void (*)(const float* values, std::size_t groups, PairWeight weight, float factor, float* sums);

// The kernel of one instruction set by name, "sse2", "avx2" or "avx512", for the test that all
// agree; null where the machine lacks it.
PlaneKernel plane_kernel(const char* instruction_set);

}  // namespace landmarkdb
