#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "engine/registration/plane_sums.hpp"
#include "engine/registration/surface_grid.hpp"

namespace landmarkdb {

// Points with their normals in groups of 16, as loops over whole groups want them: the x of all,
// the y, the z, then the same of the normals. A last group that is not full ends in points without
// a normal (all zero), which pair with nothing.
class PointGroups {
 public:
  static constexpr std::size_t kLanes = 16;
  static constexpr std::size_t kNumbers = 6;  // of a point

  PointGroups() = default;
  // Every `stride`-th point; one unit normal a point.
  PointGroups(std::span<const Eigen::Vector3f> points,
              std::span<const Eigen::Vector3f> normals,
              std::size_t stride = 1);

  std::size_t size() const { return size_; }  // points
  std::size_t groups() const { return groups_for(size_); }
  // Whole groups that hold `points`.
  static std::size_t groups_for(std::size_t points) { return (points + kLanes - 1) / kLanes; }
  // Points in the first `groups` groups.
  std::size_t size_of(std::size_t groups) const { return std::min(groups * kLanes, size_); }
  const float* group(std::size_t i) const { return values_.data() + i * kLanes * kNumbers; }

 private:
  std::vector<float> values_;
  std::size_t size_ = 0;
};

// Carries points into the frame of a surface; the translation in metres.
struct PointMotion {
  Eigen::Matrix3f R_target_source = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t_target_source = Eigen::Vector3f::Zero();
};

// How a point's factor follows from the cosine between its normal and the surface's.
enum class PairFactor {
  kGraded,  // the cosine, 0 below zero
  kWhole,   // 1 from `min_agreement` on, otherwise 0
};

struct PairOptions {
  PairFactor factor = PairFactor::kGraded;
  float min_agreement = 0.0F;                        // of kWhole, more than 0
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  // from which points are told, target frame
};

struct FitOptions {
  float factor = -1.0F;          // of d^2 in the exponent: -1 / (2 sigma^2), 1/m^2
  std::size_t first_groups = 1;  // after which a hopeless pose is given up
  float hopeless = 0.0F;         // mean fit of those groups below which it is
};

// What runs over groups on one instruction set. All give the same bytes.
struct PairKernels {
  // Pairs each point with the plane of the surface near: 16 numbers each of the plane's normal, the
  // point from the centre, its distance from the plane and its factor, as PlaneSummer takes them.
  // Where no surface is near, normal and factor are zero.
  void (*pair)(const SurfaceGrid& target,
               const float* group,
               std::size_t groups,
               const PointMotion& motion,
               const PairOptions& options,
               float* values);
  // The mean over `points` of how well each lies on the surface, max(0, n.n') exp(factor d^2), of
  // at most `groups` groups; one given up early gets the mean so far less one.
  float (*mean_fit)(const SurfaceGrid& target,
                    const float* group,
                    std::size_t groups,
                    std::size_t points,
                    const PointMotion& motion,
                    const FitOptions& options);
  // How well each point lies on the surface, as in mean_fit, 16 numbers a group.
  void (*fits)(const SurfaceGrid& target,
               const float* group,
               std::size_t groups,
               const PointMotion& motion,
               float factor,
               float* fits);
};

// The best this machine has.
const PairKernels& pair_kernels();

// Pairs the points of the first `groups` groups with the surface and adds the pairs up.
PlaneSums pair_and_sum(const SurfaceGrid& target,
                       const PointGroups& points,
                       std::size_t groups,
                       const PointMotion& motion,
                       const PairOptions& options,
                       PlaneSummer summer);

// Those of one instruction set by name, "sse2", "avx2" or "avx512", for the test that all agree;
// null where the machine lacks it.
const PairKernels* pair_kernels(const char* instruction_set);

}  // namespace landmarkdb
