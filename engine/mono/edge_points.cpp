#include "engine/mono/edge_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "engine/mono/gradient_rows.hpp"

namespace landmarkdb {
namespace {

constexpr double kLevelsPerUnit = 1.0 / kGradientPerLevel;

// Offset of a parabola's top through (-1, before), (0, top), (1, after), within +-0.5.
float top_of_parabola(float before, float top, float after) {
  const float curve = before - 2.0F * top + after;
  return curve < 0.0F ? std::clamp(0.5F * (before - after) / curve, -0.5F, 0.5F) : 0.0F;
}

float length_of(std::int32_t squared) { return std::sqrt(static_cast<float>(squared)); }

// The edge points of row y, at the pixels `columns`.
void append_points(EdgeMap& map,
                   const GradientRows& rows,
                   std::span<const std::int32_t> columns,
                   std::uint32_t y) {
  const float contrast = static_cast<float>(rows.contrast_scale * kLevelsPerUnit);
  std::size_t next = map.points.size();
  map.points.resize(next + columns.size());
  map.contrasts.resize(next + columns.size());
  map.columns.insert(map.columns.end(), columns.begin(), columns.end());
  for (const std::int32_t x : columns) {
    const std::size_t at = static_cast<std::size_t>(x) + kRowMargin;
    const float gx = rows.gx[at], gy = rows.gy[at];
    const float length = length_of(rows.squared[at]);
    const bool in_row = std::abs(gx) > std::abs(gy);
    const std::int32_t before = in_row ? rows.squared[at - 1] : rows.above[at];
    const std::int32_t after = in_row ? rows.squared[at + 1] : rows.below[at];
    const float offset = top_of_parabola(length_of(before), length, length_of(after));
    map.points[next] = {{static_cast<float>(x) + (in_row ? offset : 0.0F),
                         static_cast<float>(y) + (in_row ? 0.0F : offset)},
                        {gx / length, gy / length}};
    map.contrasts[next++] = length * contrast;
  }
}

// Where flags are 1. They are looked at eight at a time: those past `width` are 0, eight of them.
void find_flagged(std::span<const std::uint8_t> flags,
                  std::uint32_t width,
                  std::vector<std::int32_t>& columns) {
  columns.clear();
  for (std::uint32_t x = 0; x < width; x += sizeof(std::uint64_t)) {
    std::uint64_t eight = 0;
    std::memcpy(&eight, flags.data() + x, sizeof eight);
    if (eight == 0) continue;
    if constexpr (std::endian::native == std::endian::big) eight = __builtin_bswap64(eight);
    for (; eight != 0; eight &= eight - 1)
      columns.push_back(static_cast<std::int32_t>(x) + std::countr_zero(eight) / 8);
  }
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
  GradientFilter filter(image, options.smooth);
  double floor = map.low_contrast;
  std::vector<std::uint8_t> flags(filter.row_size() + sizeof(std::uint64_t), 0);
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
