#include "engine/registration/name_cells.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kStride = 6;
constexpr int kReach = 2;
constexpr std::size_t kCells = std::size_t{BlockFill::kSide} * BlockFill::kSide * BlockFill::kSide;

// The block whose first cell is (8, -8, 0) of cells a metre wide, and surfels in and about it.
struct Block {
  std::array<std::uint32_t, kCells> named{};
  std::array<float, kCells> nearest{};
  std::vector<float> surfels;
  std::vector<std::uint32_t> order;
  BlockFill fill;

  explicit Block(std::size_t count) : surfels((count + 1) * kStride), order(count) {
    nearest.fill(std::numeric_limits<float>::infinity());
    std::iota(order.begin(), order.end(), 1U);
    Random random(count);
    const float first[3] = {8.0F, -8.0F, 0.0F};
    for (std::size_t i = 1; i <= count; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        surfels[i * kStride + axis] = first[axis] + static_cast<float>(random.uniform(-2.0, 10.0));
      }
    }
    fill = {.named = named.data(),
            .nearest_m2 = nearest.data(),
            .inverse_cell = 1.0F,
            .reach = kReach,
            .most_m2 = 4.75F,
            .surfels = order};
    for (int axis = 0; axis < 3; ++axis) {
      fill.first_cell[axis] = static_cast<int>(first[axis]);
      for (int i = 0; i < BlockFill::kSide; ++i) {
        fill.middle_m[axis][i] = first[axis] + static_cast<float>(i) + 0.5F;
      }
    }
  }

  float squared(std::size_t cell, std::uint32_t surfel) const {
    float sum = 0.0F;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t i = (cell >> (3 * axis)) & 7U;
      const float away = fill.middle_m[axis][i] - surfels[surfel * kStride + axis];
      sum += away * away;
    }
    return sum;
  }
};

TEST(NameCells, NamesTheNearestSurfelWithinReach) {
  Block block(40);
  cell_namer()(block.fill, block.surfels.data(), kStride);
  const auto named =
      std::count_if(block.named.begin(), block.named.end(), [](std::uint32_t n) { return n != 0; });
  ASSERT_GT(named, 100);
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t surfel : block.order) {
      least = std::min(least, block.squared(cell, surfel));
    }
    if (least < 4.0F) {  // certainly within two cells along each axis
      ASSERT_NE(block.named[cell], 0U) << cell;
      EXPECT_FLOAT_EQ(block.squared(cell, block.named[cell]), least) << cell;
    } else if (least > 4.8F) {
      EXPECT_EQ(block.named[cell], 0U) << cell;
    }
  }
}

TEST(NameCells, LetsTheFirstOfTwoAsNearStay) {
  Block block(2);
  std::fill(block.surfels.begin(), block.surfels.end(), 0.5F);
  for (const std::size_t i : {1U, 2U}) {
    block.surfels[i * kStride] = 8.5F;
    block.surfels[i * kStride + 1] = -7.5F;
  }
  cell_namer()(block.fill, block.surfels.data(), kStride);
  EXPECT_EQ(block.named[0], 1U);
}

TEST(NameCells, IsTheSameOnAllInstructionSets) {
  for (const std::size_t count : {1U, 10U, 300U}) {
    Block baseline(count);
    cell_namer("sse2")(baseline.fill, baseline.surfels.data(), kStride);
    for (const char* name : {"avx2", "avx512"}) {
      const CellNamer other = cell_namer(name);
      if (other == nullptr) continue;
      Block block(count);
      other(block.fill, block.surfels.data(), kStride);
      EXPECT_EQ(block.named, baseline.named) << name;
      EXPECT_EQ(block.nearest, baseline.nearest) << name;
    }
  }
}

}  // namespace
}  // namespace landmarkdb
