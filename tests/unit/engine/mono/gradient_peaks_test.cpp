#include "engine/mono/gradient_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

// Rows of any gradients.
struct Rows {
  explicit Rows(std::size_t width, std::uint64_t seed) {
    Random random(seed);
    const auto draw = [&] { return static_cast<std::int32_t>(random.below(2001)) - 1000; };
    for (std::size_t i = 0; i < width + 2 * kRowMargin; ++i) {
      gx.push_back(static_cast<std::int16_t>(draw()));
      gy.push_back(static_cast<std::int16_t>(draw()));
      squared.push_back(gx.back() * gx.back() + gy.back() * gy.back());
      above.push_back(std::abs(draw()) * 1000);
      below.push_back(std::abs(draw()) * 1000);
    }
  }
  GradientRows view() const {
    return {gx.data(), gy.data(), squared.data(), above.data(), below.data()};
  }

  std::vector<std::int16_t> gx, gy;
  std::vector<std::int32_t> squared, above, below;
};

float root(std::int32_t squared) { return std::sqrt(static_cast<float>(squared)); }

float top_of_parabola(float before, float top, float after) {
  const float curve = before - 2.0F * top + after;
  return curve < 0.0F ? std::clamp(0.5F * (before - after) / curve, -0.5F, 0.5F) : 0.0F;
}

EdgePoint place_one(const Rows& rows, std::int32_t x, std::uint32_t y) {
  const std::size_t at = static_cast<std::size_t>(x) + kRowMargin;
  const float length = root(rows.squared[at]);
  const bool in_row = std::abs(rows.gx[at]) > std::abs(rows.gy[at]);
  const float before = root(in_row ? rows.squared[at - 1] : rows.above[at]);
  const float after = root(in_row ? rows.squared[at + 1] : rows.below[at]);
  const float offset = top_of_parabola(before, length, after);
  return {{static_cast<float>(x) + (in_row ? offset : 0.0F),
           static_cast<float>(y) + (in_row ? 0.0F : offset)},
          {rows.gx[at] / length, rows.gy[at] / length}};
}

TEST(PlacePeaks, PlacesManyAtOnceAsOneByOne) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const Rows rows(50, seed);
    std::vector<std::int32_t> columns;
    for (std::int32_t x = 0; x < 50; x += 1 + static_cast<std::int32_t>(seed % 5))
      columns.push_back(x);
    std::vector<EdgePoint> points(columns.size());
    std::vector<float> lengths(columns.size());
    place_peaks(rows.view(), 7, columns, points.data(), lengths.data());
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const EdgePoint want = place_one(rows, columns[i], 7);
      EXPECT_EQ(points[i].uv, want.uv);
      EXPECT_EQ(points[i].normal, want.normal);
      EXPECT_EQ(lengths[i], root(rows.squared[static_cast<std::size_t>(columns[i]) + kRowMargin]));
    }
  }
}

TEST(PlacePeaks, WritesNothingPastTheLastColumn) {
  const Rows rows(20, 1);
  const std::vector<std::int32_t> columns{2, 3, 5, 8, 13};
  const EdgePoint untouched{{-1.0F, -2.0F}, {-3.0F, -4.0F}};
  std::vector<EdgePoint> points(8, untouched);
  std::vector<float> lengths(8, -1.0F);
  place_peaks(rows.view(), 0, columns, points.data(), lengths.data());
  for (std::size_t i = columns.size(); i < points.size(); ++i) {
    EXPECT_EQ(points[i].uv, untouched.uv);
    EXPECT_EQ(points[i].normal, untouched.normal);
    EXPECT_EQ(lengths[i], -1.0F);
  }
}

}  // namespace
}  // namespace landmarkdb
