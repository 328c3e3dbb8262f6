#include "engine/mono/gradient_rows.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

// Compiled with -O3: the loops below are written for the compiler's vectors of 16- and 32-bit
// integers.
namespace landmarkdb {
namespace {

// Where the machine has longer vectors they are used: integers come out the same.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LANDMARKDB_LONG_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define LANDMARKDB_LONG_VECTORS
#endif

constexpr std::int64_t kAhead = 4;  // rows the last filter looks ahead of the row it gives

LANDMARKDB_LONG_VECTORS
void smooth_across(const std::uint8_t* __restrict in,
                   std::uint16_t* __restrict out,
                   std::size_t n) {
  for (std::size_t i = 2; i + 2 < n; ++i) {
    out[i] =
        static_cast<std::uint16_t>(in[i - 2] + in[i + 2] + 4 * (in[i - 1] + in[i + 1]) + 6 * in[i]);
  }
}

// The sum of weights is 256; 16 of it stay as fractions of a grey level. Sums are at most 16 *
// 4080: 16 bits are enough.
LANDMARKDB_LONG_VECTORS
void smooth_down(const std::uint16_t* __restrict a,
                 const std::uint16_t* __restrict b,
                 const std::uint16_t* __restrict c,
                 const std::uint16_t* __restrict d,
                 const std::uint16_t* __restrict e,
                 std::int16_t* __restrict out,
                 std::size_t n) {
  for (std::size_t i = 2; i + 2 < n; ++i) {
    const auto sum = static_cast<std::uint16_t>(8 + a[i] + e[i] + 4 * (b[i] + d[i]) + 6 * c[i]);
    out[i] = static_cast<std::int16_t>(sum >> 4);
  }
}

LANDMARKDB_LONG_VECTORS
void differentiate(const std::int16_t* __restrict above,
                   const std::int16_t* __restrict row,
                   const std::int16_t* __restrict below,
                   std::int16_t* __restrict gx,
                   std::int16_t* __restrict gy,
                   std::int32_t* __restrict squared,
                   std::size_t n) {
  for (std::size_t i = 3; i + 3 < n; ++i) {
    // At most 4 * 4080: 16 bits are enough, and twice as many of them are worked out at once.
    const auto dx =
        static_cast<std::int16_t>((above[i + 1] - above[i - 1]) + 2 * (row[i + 1] - row[i - 1]) +
                                  (below[i + 1] - below[i - 1]));
    const auto dy = static_cast<std::int16_t>(
        (below[i - 1] - above[i - 1]) + 2 * (below[i] - above[i]) + (below[i + 1] - above[i + 1]));
    gx[i] = dx;
    gy[i] = dy;
    squared[i] = dx * dx + dy * dy;
  }
}

}  // namespace

GradientFilter::GradientFilter(const GreyImage& image, bool smooth)
    : image_(image), smooth_(smooth), row_size_(image.width + 2 * kRowMargin), read_(-kAhead) {
  source_.resize(row_size_);
  for (auto& row : across_.rows) row.resize(row_size_);
  for (auto& row : smoothed_.rows) row.resize(row_size_);
  for (auto* ring : {&gx_, &gy_}) {
    for (auto& row : ring->rows) row.resize(row_size_);
  }
  for (auto& row : squared_.rows) row.resize(row_size_);
  for (std::int64_t i = 0; i < 2 * kAhead; ++i) advance();
}

void GradientFilter::advance() {
  const std::int64_t y = read_++;
  const auto last = static_cast<std::int64_t>(image_.height) - 1;
  const std::uint8_t* from =
      image_.pixels.data() +
      static_cast<std::size_t>(std::clamp<std::int64_t>(y, 0, last)) * image_.width;
  std::memset(source_.data(), from[0], kRowMargin);
  std::memcpy(source_.data() + kRowMargin, from, image_.width);
  std::memset(source_.data() + kRowMargin + image_.width, from[image_.width - 1], kRowMargin);
  if (smooth_) {
    smooth_across(source_.data(), across_.at(y), row_size_);
  } else {
    for (std::size_t i = 0; i < row_size_; ++i) {
      across_.at(y)[i] = static_cast<std::uint16_t>(source_[i] * 16);
    }
  }
  const std::int64_t s = y - 2;  // the row whose five are there now
  if (smooth_) {
    smooth_down(across_.at(s - 2),
                across_.at(s - 1),
                across_.at(s),
                across_.at(s + 1),
                across_.at(s + 2),
                smoothed_.at(s),
                row_size_);
  } else {
    std::copy_n(across_.at(s), row_size_, smoothed_.at(s));
  }
  const std::int64_t g = s - 1;
  differentiate(smoothed_.at(g - 1),
                smoothed_.at(g),
                smoothed_.at(g + 1),
                gx_.at(g),
                gy_.at(g),
                squared_.at(g),
                row_size_);
}

GradientRows GradientFilter::next_row() {
  advance();
  constexpr double kUnsmoothedStep = 64.0;  // what a step of one level peaks at without smoothing
  const std::int64_t y = read_ - 1 - kAhead;
  return {gx_.at(y),
          gy_.at(y),
          squared_.at(y),
          squared_.at(y - 1),
          squared_.at(y + 1),
          smooth_ ? 1.0 : kGradientPerLevel / kUnsmoothedStep};
}

LANDMARKDB_LONG_VECTORS
void mark_maxima(const GradientRows& rows,
                 std::size_t width,
                 std::int32_t least_squared,
                 std::uint8_t* __restrict flags) {
  const std::int16_t* __restrict gx = rows.gx + kRowMargin;
  const std::int16_t* __restrict gy = rows.gy + kRowMargin;
  const std::int32_t* __restrict m = rows.squared + kRowMargin;
  const std::int32_t* __restrict above = rows.above + kRowMargin;
  const std::int32_t* __restrict below = rows.below + kRowMargin;
  for (std::size_t x = 0; x < width; ++x) {
    const std::int32_t here = m[x];
    const int flat = std::abs(static_cast<int>(gx[x])) > std::abs(static_cast<int>(gy[x]));
    const int along_row = (here > m[static_cast<std::ptrdiff_t>(x) - 1]) & (here >= m[x + 1]);
    const int along_column = (here > above[x]) & (here >= below[x]);
    flags[x] = static_cast<std::uint8_t>((here > least_squared) &
                                         ((flat & along_row) | ((flat ^ 1) & along_column)));
  }
}

}  // namespace landmarkdb
