#include "engine/matching/lanes.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

struct Pair {
  std::vector<float> a, b;
};

Pair random_pair(std::size_t n, std::uint64_t seed) {
  Random random(seed);
  Pair pair{std::vector<float>(n), std::vector<float>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    pair.a[i] = random.uniform() < 0.3 ? 0.0F : static_cast<float>(random.uniform());
    pair.b[i] = random.uniform() < 0.3 ? 0.0F : static_cast<float>(random.uniform());
  }
  return pair;
}

TEST(LaneKernels, GiveTheSameBytesOnEveryInstructionSet) {
  const LaneKernels* baseline = lane_kernels("sse2");
  ASSERT_NE(baseline, nullptr);
  for (const char* name : {"avx2", "avx512"}) {
    const LaneKernels* kernels = lane_kernels(name);
    if (kernels == nullptr) continue;
    for (std::size_t n = 0; n < 400; n += 11) {
      const Pair p = random_pair(n, n);
      const float* a = p.a.data();
      const float* b = p.b.data();
      EXPECT_EQ(kernels->squared_l2(a, b, n), baseline->squared_l2(a, b, n)) << name;
      EXPECT_EQ(kernels->l1(a, b, n), baseline->l1(a, b, n)) << name;
      EXPECT_EQ(kernels->chi2(a, b, n), baseline->chi2(a, b, n)) << name;
      EXPECT_EQ(kernels->intersection(a, b, n), baseline->intersection(a, b, n)) << name;
    }
  }
}

TEST(LaneKernels, SumWhatTheirNamesSay) {
  for (const std::size_t n : {1U, 15U, 16U, 17U, 352U}) {
    const Pair p = random_pair(n, n + 7);
    double squared = 0.0;
    double l1 = 0.0;
    double chi2 = 0.0;
    double intersection = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      const double a = static_cast<double>(p.a[i]);
      const double b = static_cast<double>(p.b[i]);
      squared += (a - b) * (a - b);
      l1 += std::abs(a - b);
      if (a + b > 0.0) chi2 += (a - b) * (a - b) / (a + b);
      intersection += std::min(a, b);
    }
    const LaneKernels& kernels = lane_kernels();
    EXPECT_NEAR(kernels.squared_l2(p.a.data(), p.b.data(), n), squared, 1e-5 * squared);
    EXPECT_NEAR(kernels.l1(p.a.data(), p.b.data(), n), l1, 1e-5 * l1);
    EXPECT_NEAR(kernels.chi2(p.a.data(), p.b.data(), n), chi2, 1e-5 * chi2);
    EXPECT_NEAR(kernels.intersection(p.a.data(), p.b.data(), n),
                intersection,
                1e-5 * static_cast<double>(n));
  }
}

TEST(LaneKernels, KnowNoOtherInstructionSet) { EXPECT_EQ(lane_kernels("mmx"), nullptr); }

}  // namespace
}  // namespace landmarkdb
