#include "engine/matching/dot_tiles.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

TEST(DotKernel, EveryInstructionSetGivesTheInnerProducts) {
  for (const char* name : {"baseline", "avx2", "avx512"}) {
    const DotKernel* kernel = dot_kernel(name);
    if (kernel == nullptr) continue;
    ASSERT_LE(kernel->queries, kMaxTileQueries);
    for (const std::size_t length : {0U, 1U, 7U, 352U}) {
      Random random(length);
      std::vector<float> queries(kernel->queries * length);
      std::vector<float> targets(kTileTargets * length);
      for (float& v : queries) v = static_cast<float>(random.uniform(-1, 1));
      for (float& v : targets) v = static_cast<float>(random.uniform(-1, 1));
      std::vector<float> tile(kernel->queries * kTileTargets, -7.0F);
      kernel->tile(queries.data(), targets.data(), length, tile.data());
      for (std::size_t i = 0; i < kernel->queries; ++i) {
        for (std::size_t j = 0; j < kTileTargets; ++j) {
          double expected = 0.0;
          for (std::size_t k = 0; k < length; ++k) {
            expected += static_cast<double>(queries[k * kernel->queries + i]) *
                        static_cast<double>(targets[k * kTileTargets + j]);
          }
          EXPECT_NEAR(tile[i * kTileTargets + j], expected, 1e-4) << name << " " << i << " " << j;
        }
      }
    }
  }
}

TEST(DotKernel, KnowsNoOtherInstructionSet) { EXPECT_EQ(dot_kernel("mmx"), nullptr); }

}  // namespace
}  // namespace landmarkdb
