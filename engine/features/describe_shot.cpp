#include "engine/features/describe_shot.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/cloud/cell_grid.hpp"
#include "engine/features/check_cloud.hpp"
#include "engine/features/shot_describer.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "describe";

// Keypoints described at once: enough to make PCL's set-up (some microseconds) vanish, few enough
// that a stop request is noticed within 100 ms at 3 ms a descriptor, ten times PCL's usual cost.
constexpr std::size_t kBlock = 32;

// Cells of half the radius test about twice as many points as lie in reach on a surface; smaller
// cells cost more in look-ups than they save (125 columns against 25).
constexpr double kCellsPerRadius = 2.0;

std::vector<std::uint32_t> places_of_points(const CellGrid& grid) {
  std::vector<std::uint32_t> place_of(grid.size());
  for (std::size_t place = 0; place < grid.size(); ++place) {
    place_of[grid.order()[place]] = static_cast<std::uint32_t>(place);
  }
  return place_of;
}

// The keypoints by the place of their point: what follows each other lies close together.
std::vector<std::uint32_t> spatial_order(const std::vector<std::uint32_t>& place_of,
                                         const Keypoints& keypoints) {
  std::vector<std::uint32_t> sorted(keypoints.size());
  std::iota(sorted.begin(), sorted.end(), 0U);
  std::stable_sort(sorted.begin(), sorted.end(), [&](std::uint32_t a, std::uint32_t b) {
    return place_of[keypoints.index[a]] < place_of[keypoints.index[b]];
  });
  return sorted;
}

// Drops the rows that are not valid; the order of the rest stays.
DescriptorSet keep_valid(const PreparedCloud& cloud,
                         const Keypoints& keypoints,
                         const std::vector<ShotRow>& rows,
                         std::vector<float> values) {
  DescriptorSet set;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i].valid) continue;
    const std::uint32_t index = keypoints.index[i];
    set.keypoints.push_back(cloud.points[index]);
    set.normals.push_back(cloud.normals[index]);
    set.frames.push_back(rows[i].frame);
    if (kept != i) {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i * kShotLength),
                  kShotLength,
                  values.begin() + static_cast<std::ptrdiff_t>(kept * kShotLength));
    }
    ++kept;
  }
  values.resize(kept * kShotLength);
  set.values = std::move(values);
  set.dropped = rows.size() - kept;
  return set;
}

}  // namespace

DescriptorSet describe_shot(const PreparedCloud& cloud,
                            const Keypoints& keypoints,
                            double radius_m,
                            const RunContext& context,
                            ShotMethod method) {
  check_cloud(cloud, kStage);
  check_length(radius_m, "SHOT radius");
  for (const std::uint32_t index : keypoints.index) {
    if (index >= cloud.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "keypoint names point " + std::to_string(index) + " of a cloud of " +
                      std::to_string(cloud.size()));
    }
  }
  context.report(kStage, 0, keypoints.size());
  if (keypoints.index.empty()) return {};

  const CellGrid grid(cloud.points, radius_m / kCellsPerRadius);
  const auto radius = static_cast<float>(radius_m);
  const std::unique_ptr<ShotDescriber> shot = method == ShotMethod::kPcl
                                                  ? make_pcl_shot(grid, cloud.normals, radius)
                                                  : make_fast_shot(grid, cloud.normals, radius);
  const std::vector<std::uint32_t> place_of = places_of_points(grid);
  const std::vector<std::uint32_t> sorted = spatial_order(place_of, keypoints);

  std::vector<ShotRow> rows(keypoints.size());
  std::vector<float> values(keypoints.size() * kShotLength);
  const std::size_t blocks = (sorted.size() + kBlock - 1) / kBlock;
  std::atomic<std::size_t> next{0};
  // Threads take blocks as they come (dense places cost more); each block's rows are its own, so
  // who describes it does not show in the result.
  const auto work = [&](std::size_t worker, std::size_t) {
    std::vector<std::uint32_t> places;
    std::vector<ShotRow> block_rows;
    std::vector<float*> block_values;
    while (!context.should_stop()) {
      const std::size_t block = next.fetch_add(1);
      if (block >= blocks) return;
      const std::size_t begin = block * kBlock;
      const std::size_t end = std::min(begin + kBlock, sorted.size());
      places.clear();
      block_values.clear();
      block_rows.assign(end - begin, {});
      for (std::size_t i = begin; i < end; ++i) {
        places.push_back(place_of[keypoints.index[sorted[i]]]);
        block_values.push_back(values.data() + sorted[i] * kShotLength);
      }
      shot->describe(places, block_rows, block_values);
      for (std::size_t i = begin; i < end; ++i) rows[sorted[i]] = block_rows[i - begin];
      if (worker == 0) context.report(kStage, begin, keypoints.size());
    }
  };
  const auto threads = static_cast<std::size_t>(std::max(context.threads, 1));
  parallel_chunks(std::min(threads, blocks), context.threads, work);
  context.report(kStage, keypoints.size(), keypoints.size());
  return keep_valid(cloud, keypoints, rows, std::move(values));
}

}  // namespace landmarkdb
