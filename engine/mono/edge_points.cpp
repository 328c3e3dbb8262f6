#include "engine/mono/edge_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "engine/mono/gradient_peaks.hpp"
#include "engine/mono/gradient_rows.hpp"

namespace landmarkdb {
namespace {

constexpr double kLevelsPerUnit = 1.0 / kGradientPerLevel;

// The edge points of row y, at the pixels `columns`.
void append_points(EdgeMap& map,
                   const GradientRows& rows,
                   std::span<const std::int32_t> columns,
                   std::uint32_t y) {
  const std::size_t next = map.points.size();
  map.points.resize(next + columns.size());
  map.contrasts.resize(next + columns.size());
  map.columns.insert(map.columns.end(), columns.begin(), columns.end());
  place_peaks(rows, y, columns, map.points.data() + next, map.contrasts.data() + next);
  const float contrast = static_cast<float>(rows.contrast_scale * kLevelsPerUnit);
  for (std::size_t i = next; i < map.contrasts.size(); ++i) map.contrasts[i] *= contrast;
}

// The flags of 64 pixels, 1 or 0, as bits.
std::uint64_t bits_of(const std::uint8_t* flags) {
  std::uint64_t bits = 0;
  for (unsigned byte = 0; byte < 8; ++byte) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, flags + std::size_t{8} * byte, sizeof eight);
    if constexpr (std::endian::native == std::endian::big) eight = __builtin_bswap64(eight);
    constexpr std::uint64_t kGather = 0x0102040810204080;  // flag k to bit 56 + k
    bits |= (eight * kGather >> 56U) << 8U * byte;
  }
  return bits;
}

// Where flags are 1. They are looked at 64 at a time: those past `width` are 0, up to 64 of them.
void find_flagged(std::span<const std::uint8_t> flags,
                  std::uint32_t width,
                  std::vector<std::int32_t>& columns) {
  columns.resize(width);
  std::int32_t* next = columns.data();
  for (std::uint32_t x = 0; x < width; x += 64) {
    for (std::uint64_t bits = bits_of(flags.data() + x); bits != 0; bits &= bits - 1)
      *next++ = static_cast<std::int32_t>(x) + std::countr_zero(bits);
  }
  columns.resize(static_cast<std::size_t>(next - columns.data()));
}

// Keeps the points at or above a contrast. `rows_done` rows have their start.
void drop_below(EdgeMap& map, double contrast, std::size_t rows_done) {
  std::size_t kept = 0, row = 0;
  std::vector<std::uint32_t> starts(map.row_starts.size(), 0);
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    while (row < rows_done && map.row_starts[row] <= i) {
      starts[row++] = static_cast<std::uint32_t>(kept);
    }
    if (map.contrasts[i] < contrast) continue;
    map.points[kept] = map.points[i];
    map.columns[kept] = map.columns[i];
    map.contrasts[kept++] = map.contrasts[i];
  }
  while (row < rows_done) starts[row++] = static_cast<std::uint32_t>(kept);
  map.row_starts = starts;
  map.points.resize(kept);
  map.columns.resize(kept);
  map.contrasts.resize(kept);
}

constexpr std::size_t kPixelsAPoint = 8;  // at least, in most images

void reserve(EdgeMap& map, std::size_t points) {
  map.points.reserve(points);
  map.columns.reserve(points);
  map.contrasts.reserve(points);
}

double median_of(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What noise of one grey level makes of the gradient, as contrast: the root of the summed squares
// of the filter's weights (binomial 5 with Sobel, or Sobel alone), over a step's response.
constexpr double kNoiseSmoothed = 1.088 / 2.5;
constexpr double kNoiseUnsmoothed = 3.464 / 4.0;

void choose_thresholds(EdgeMap& map, const GreyImage& image, const EdgeOptions& options) {
  // 3.5 sigma: one false maximum in 450 pixels of pure noise (Rayleigh), where a chain takes
  // twelve. 3 levels: the blocks of a JPEG and the steps of rounding stay below.
  constexpr double kSigmas = 3.5;
  constexpr double kLeast = 3.0;
  // Uneven light makes edges of some low contrasts; what is fainter than this has to be straight.
  constexpr double kHighOverLow = 4.0;
  const double noise = options.smooth ? kNoiseSmoothed : kNoiseUnsmoothed;
  map.low_contrast = options.low_contrast > 0.0
                         ? options.low_contrast
                         : std::max(kLeast, kSigmas * noise * image_noise(image));
  map.high_contrast =
      options.high_contrast > 0.0 ? options.high_contrast : kHighOverLow * map.low_contrast;
}

}  // namespace

double image_noise(const GreyImage& image) {
  constexpr std::uint32_t kRowStep = 8;
  constexpr double kNormalMedian = 0.6745, kFilterNorm = 6.0;  // of [1 -2 1] x [1 -2 1]
  if (image.width < 3 || image.height < 3) return 0.0;
  std::array<std::uint32_t, 2048> histogram{};  // |value| is at most 8 * 255
  std::uint32_t total = 0;
  for (std::size_t y = 1; y + 1 < image.height; y += kRowStep) {
    const std::uint8_t* above = image.pixels.data() + (y - 1) * image.width;
    const std::uint8_t* row = above + image.width;
    const std::uint8_t* below = row + image.width;
    for (std::size_t x = 1; x + 1 < image.width; ++x) {
      const int value = above[x - 1] - 2 * above[x] + above[x + 1] - 2 * row[x - 1] + 4 * row[x] -
                        2 * row[x + 1] + below[x - 1] - 2 * below[x] + below[x + 1];
      ++histogram[static_cast<std::size_t>(std::abs(value))];
      ++total;
    }
  }
  std::uint32_t seen = 0;
  std::size_t median = 0;
  while (median + 1 < histogram.size() && (seen += histogram[median]) * 2 < total) ++median;
  return static_cast<double>(median) / (kNormalMedian * kFilterNorm);
}

EdgeMap find_edge_points(const GreyImage& image,
                         const EdgeOptions& options,
                         const RunContext& run) {
  EdgeMap map;
  choose_thresholds(map, image, options);
  map.row_starts.assign(std::size_t{image.height} + 1, 0);
  if (image.width == 0 || image.height == 0) return map;
  reserve(map, std::min(options.max_points, image.pixels.size() / kPixelsAPoint));
  GradientFilter filter(image, options.smooth);
  double floor = map.low_contrast;
  std::vector<std::uint8_t> flags(std::size_t{image.width} + 64, 0);
  std::vector<std::int32_t> columns;
  for (std::uint32_t y = 0; y < image.height; ++y) {
    constexpr std::uint32_t kRowsBetweenChecks = 64;
    if (y % kRowsBetweenChecks == 0) run.check("features");
    map.row_starts[y] = static_cast<std::uint32_t>(map.points.size());
    const GradientRows rows = filter.next_row();
    constexpr double kSteepest = 40'000.0;  // no gradient is longer
    const double least = std::min(floor * kGradientPerLevel / rows.contrast_scale, kSteepest);
    mark_maxima(rows, image.width, static_cast<std::int32_t>(least * least), flags.data());
    find_flagged(flags, image.width, columns);
    append_points(map, rows, columns, y);
    if (map.points.size() > options.max_points) {
      floor = median_of(map.contrasts);
      drop_below(map, std::nextafter(floor, 2.0 * floor), std::size_t{y} + 1);
    }
  }
  map.low_contrast = floor;
  map.high_contrast = std::max(map.high_contrast, floor);
  map.row_starts[image.height] = static_cast<std::uint32_t>(map.points.size());
  return map;
}

}  // namespace landmarkdb
