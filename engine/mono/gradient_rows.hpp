#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/types/grey_image.hpp"

namespace landmarkdb {

// Gradients come times 40: a step of one grey level, smoothed, peaks there (2.5 levels in Sobel's
// weights, times the 16 that the smoothed values keep of their fractions).
inline constexpr double kGradientPerLevel = 40.0;
// Rows have that many more values on either side, for the filters' neighbours.
inline constexpr std::size_t kRowMargin = 4;

// One row of gradients with the squared lengths of its neighbours; pixel x is at x + kRowMargin.
struct GradientRows {
  const std::int16_t* gx = nullptr;
  const std::int16_t* gy = nullptr;
  const std::int32_t* squared = nullptr;  // gx^2 + gy^2
  const std::int32_t* above = nullptr;    // the same of the row above, and below
  const std::int32_t* below = nullptr;
  double contrast_scale = 1.0;  // a step's contrast is length * scale / kGradientPerLevel
};

// Smooths by a binomial of five, differentiates by Sobel, row after row, with the image's border
// repeated outside. All in integers: the same on every machine.
class GradientFilter {
 public:
  GradientFilter(const GreyImage& image, bool smooth);  // `image` must outlive the filter

  std::size_t row_size() const { return row_size_; }
  // The gradients of the next row, from the top; valid until the next call. Call it height times.
  GradientRows next_row();

 private:
  void advance();  // reads one more row of the image and filters what this completes

  template <typename T, std::size_t n>
  struct Ring {
    std::array<std::vector<T>, n> rows;
    T* at(std::int64_t y) {
      return rows[static_cast<std::size_t>(y + 4 * std::int64_t{n}) % n].data();
    }
  };

  const GreyImage& image_;
  bool smooth_;
  std::size_t row_size_;
  std::int64_t read_ = 0;  // the next row to read; starts above the image
  std::vector<std::uint8_t> source_;
  Ring<std::uint16_t, 5> across_;
  Ring<std::int16_t, 3> smoothed_;
  Ring<std::int16_t, 3> gx_, gy_;
  Ring<std::int32_t, 3> squared_;
};

// flags[x] = 1 where the gradient is above `least_squared` and the largest of its neighbours along
// the axis it is nearer to; 0 elsewhere.
void mark_maxima(const GradientRows& rows,
                 std::size_t width,
                 std::int32_t least_squared,
                 std::uint8_t* flags);

}  // namespace landmarkdb
