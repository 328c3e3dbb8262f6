#include "engine/registration/plane_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

struct Pair {
  Eigen::Vector3f normal, from_centre;
  float distance_m = 0.0F, factor = 1.0F;
};

std::vector<Pair> random_pairs(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const auto vector = [&](double size) {
    return Eigen::Vector3d(random.normal() * size, random.normal() * size, random.normal() * size);
  };
  std::vector<Pair> pairs(count);
  for (Pair& pair : pairs) {
    pair.normal = vector(1.0).normalized().cast<float>();
    pair.from_centre = vector(3.0).cast<float>();
    pair.distance_m = static_cast<float>(0.05 * random.normal());
    pair.factor = random.uniform() < 0.2 ? 0.0F : static_cast<float>(random.uniform());
  }
  return pairs;
}

constexpr std::size_t kLanes = PlaneSummer::kLanes;
constexpr std::size_t kNumbers = PlaneSummer::kNumbers;

std::size_t groups_of(std::size_t pairs) { return (pairs + kLanes - 1) / kLanes; }

// In groups as the summer takes them.
std::vector<float> grouped(const std::vector<Pair>& pairs) {
  std::vector<float> values(groups_of(pairs.size()) * kLanes * kNumbers, 0.0F);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    float* at = values.data() + i / kLanes * kLanes * kNumbers + i % kLanes;
    const Pair& pair = pairs[i];
    for (int axis = 0; axis < 3; ++axis) {
      at[static_cast<std::size_t>(axis) * kLanes] = pair.normal[axis];
      at[static_cast<std::size_t>(axis + 3) * kLanes] = pair.from_centre[axis];
    }
    at[6 * kLanes] = pair.distance_m;
    at[7 * kLanes] = pair.factor;
  }
  return values;
}

PlaneSums sum_of(const std::vector<Pair>& pairs, PairWeight weight, double scale_m) {
  PlaneSummer summer(weight, scale_m);
  const std::vector<float> values = grouped(pairs);
  const std::size_t all = groups_of(pairs.size());
  for (std::size_t first = 0; first < all; first += PlaneSummer::kMostGroups) {
    summer.add(values.data() + first * kLanes * kNumbers,
               std::min(PlaneSummer::kMostGroups, all - first));
  }
  return summer.sums();
}

PlaneSums in_double(const std::vector<Pair>& pairs, PairWeight weight, double scale_m) {
  PlaneSums sums;
  for (const Pair& pair : pairs) {
    const double d = pair.distance_m;
    const double ratio = d * d / (scale_m * scale_m);
    const double w =
        pair.factor * (weight == PairWeight::kGaussian ? std::exp(-0.5 * ratio)
                                                       : 1.0 / ((1.0 + ratio) * (1.0 + ratio)));
    const Eigen::Vector3d n = pair.normal.cast<double>();
    Eigen::Matrix<double, 6, 1> J;
    J << n, pair.from_centre.cast<double>().cross(n);
    sums.A += w * J * J.transpose();
    sums.b -= w * d * J;
    sums.weight += w;
    sums.squared_m2 += w * d * d;
    sums.pairs += pair.factor > 0.0F ? 1U : 0U;
  }
  return sums;
}

TEST(PlaneSummer, AddsUpWhatDoublesDoForAnyNumberOfPairs) {
  for (const PairWeight weight : {PairWeight::kGemanMcClure, PairWeight::kGaussian}) {
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 255U, 256U, 257U, 3000U}) {
      const std::vector<Pair> pairs = random_pairs(count, count + 1);
      const PlaneSums sums = sum_of(pairs, weight, 0.04);
      const PlaneSums expected = in_double(pairs, weight, 0.04);
      const double size = 1e-5 * (1.0 + expected.A.cwiseAbs().maxCoeff());
      EXPECT_LT((sums.A - expected.A).cwiseAbs().maxCoeff(), size) << count;
      EXPECT_EQ(sums.A, sums.A.transpose());
      EXPECT_LT((sums.b - expected.b).cwiseAbs().maxCoeff(), size) << count;
      EXPECT_NEAR(sums.weight, expected.weight, 1e-5 * (1.0 + expected.weight));
      EXPECT_NEAR(sums.squared_m2, expected.squared_m2, 1e-5 * (1e-3 + expected.squared_m2));
      EXPECT_EQ(sums.pairs, expected.pairs);
    }
  }
}

TEST(PlaneSummer, GivesAFarPairNoWeight) {
  Pair pair = random_pairs(1, 3)[0];
  pair.distance_m = 1e6F;
  pair.factor = 1.0F;
  EXPECT_LT(sum_of({pair}, PairWeight::kGaussian, 0.01).weight, 1e-30);
  EXPECT_LT(sum_of({pair}, PairWeight::kGemanMcClure, 0.01).weight, 1e-12);
}

TEST(PlaneKernel, GivesTheSameBytesOnEveryInstructionSet) {
  const PlaneKernel baseline = plane_kernel("sse2");
  ASSERT_NE(baseline, nullptr);
  Random random(5);
  constexpr std::size_t kGroups = 7;
  std::vector<float> values(kGroups * kLanes * kNumbers);
  for (float& value : values) value = static_cast<float>(random.normal());
  for (const char* name : {"avx2", "avx512"}) {
    const PlaneKernel kernel = plane_kernel(name);
    if (kernel == nullptr) continue;
    for (const PairWeight weight : {PairWeight::kGemanMcClure, PairWeight::kGaussian}) {
      const float factor = weight == PairWeight::kGaussian ? -2.0F : 4.0F;
      std::array<float, kPlaneTerms> expected{};
      std::array<float, kPlaneTerms> sums{};
      baseline(values.data(), kGroups, weight, factor, expected.data());
      kernel(values.data(), kGroups, weight, factor, sums.data());
      EXPECT_EQ(std::memcmp(sums.data(), expected.data(), sizeof sums), 0) << name;
    }
  }
  EXPECT_EQ(plane_kernel("none such"), nullptr);
}

}  // namespace
}  // namespace landmarkdb
