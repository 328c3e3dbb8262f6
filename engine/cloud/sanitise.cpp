#include "engine/cloud/sanitise.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <compare>
#include <limits>
#include <string>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/cloud/keep_points.hpp"
#include "engine/cloud/reach.hpp"
#include "engine/cloud/spatial_index.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kStep = 65'536;  // points between two looks at the stop token

std::uint64_t hash(const Eigen::Vector3f& p) {
  std::uint64_t h = 0;
  for (int axis = 0; axis < 3; ++axis) {
    h ^= std::bit_cast<std::uint32_t>(p[axis] + 0.0F);  // -0 and 0 are the same place
    h *= 0x9e3779b97f4a7c15ULL;                         // 2^64 over the golden ratio
    h ^= h >> 29U;
  }
  return h * 0xbf58476d1ce4e5b9ULL;
}

// Set bits by number, of so many that few of a cloud's hashes share one.
class Marks {
 public:
  bool test(std::uint64_t number) const { return (bits_[at(number)] & bit(number)) != 0; }
  // Returns whether it was set before.
  bool set(std::uint64_t number) {
    std::uint64_t& word = bits_[at(number)];
    const bool before = (word & bit(number)) != 0;
    word |= bit(number);
    return before;
  }

 private:
  static constexpr int kBits = 23;  // 1 MiB stays in the second-level cache
  static std::size_t at(std::uint64_t number) {
    return static_cast<std::size_t>(number >> (64 - kBits) >> 6U);
  }
  static std::uint64_t bit(std::uint64_t number) {
    return std::uint64_t{1} << (number >> (64 - kBits) & 63U);
  }
  std::vector<std::uint64_t> bits_ = std::vector<std::uint64_t>(std::size_t{1} << (kBits - 6));
};

// Drops those of the points that lie exactly where an earlier one does; returns how many. Most
// share no mark with another, and are passed over.
std::size_t drop_repeats(const std::vector<Eigen::Vector3f>& points,
                         std::vector<std::uint32_t>& kept,
                         const RunContext& context) {
  std::vector<std::uint64_t> hashes(kept.size());
  parallel_chunks(kept.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) hashes[k] = hash(points[kept[k]]);
  });
  context.check("sanitise");
  Marks seen;
  Marks seen_again;
  for (const std::uint64_t h : hashes) {
    if (seen.set(h)) seen_again.set(h);
  }
  struct Marked {
    std::uint64_t hash;
    std::size_t place;  // in `kept`
    auto operator<=>(const Marked&) const = default;
  };
  std::vector<Marked> marked;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    if (seen_again.test(hashes[k])) marked.push_back({hashes[k], k});
  }
  std::sort(marked.begin(), marked.end());
  constexpr std::uint32_t kDropped = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> alike;  // of one hash, each at a place of its own
  for (std::size_t m = 0; m < marked.size(); ++m) {
    if (m == 0 || marked[m].hash != marked[m - 1].hash) alike.clear();
    std::uint32_t& i = kept[marked[m].place];
    const bool repeats = std::any_of(alike.begin(), alike.end(), [&](std::uint32_t other) {
      return points[other] == points[i];
    });
    if (!repeats) alike.push_back(i);
    if (repeats) i = kDropped;
  }
  return marked.empty() ? 0 : std::erase(kept, kDropped);
}

bool is_unit(const Eigen::Vector3f& normal) {
  constexpr float kTolerance = 0.1F;  // rounded to one digit, a unit normal is still inside
  return std::abs(normal.norm() - 1.0F) <= kTolerance;
}

void check_lengths(const PointCloud& cloud) {
  auto fits = [&](std::size_t size) { return size == 0 || size == cloud.size(); };
  if (!fits(cloud.normals.size()) || !fits(cloud.colours.size()) ||
      !fits(cloud.viewpoint_index.size())) {
    throw Error(ErrorCode::kInvalidArgument,
                "a cloud of " + std::to_string(cloud.size()) + " points has " +
                    std::to_string(cloud.normals.size()) + " normals, " +
                    std::to_string(cloud.colours.size()) + " colours and " +
                    std::to_string(cloud.viewpoint_index.size()) +
                    " viewpoint numbers, want none or one a point");
  }
  if (cloud.size() >= std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::kResourceExhausted,
                "a cloud has " + std::to_string(cloud.size()) + " points, want below 2^32");
  }
}

// Viewpoints that cannot be used (not finite, or a point names one that is not there) are worse
// than none.
void check_viewpoints(PointCloud& cloud) {
  const bool finite = std::all_of(cloud.viewpoints.begin(),
                                  cloud.viewpoints.end(),
                                  [](const Eigen::Vector3f& v) { return v.allFinite(); });
  const bool inside = std::all_of(cloud.viewpoint_index.begin(),
                                  cloud.viewpoint_index.end(),
                                  [&](std::uint16_t i) { return i < cloud.viewpoints.size(); });
  if (finite && inside) return;
  cloud.viewpoints.clear();
  cloud.viewpoint_index.clear();
}

}  // namespace

void add_counts(CloudCounts& sum, const CloudCounts& part) {
  sum.points += part.points;
  sum.not_finite += part.not_finite;
  sum.duplicates += part.duplicates;
  sum.out_of_range += part.out_of_range;
  sum.used += part.used;
}

void repair_normals(PointCloud& cloud, const RunContext& context) {
  const std::vector<Eigen::Vector3f>& points = cloud.points;
  std::vector<Eigen::Vector3f>& normals = cloud.normals;
  constexpr std::size_t kGoodPerBad = 9;
  std::vector<std::uint32_t> good;
  std::vector<std::uint32_t> bad;
  for (std::uint32_t i = 0; i < normals.size(); ++i) {
    if (is_unit(normals[i])) {
      normals[i].normalize();
      good.push_back(i);
    } else {
      bad.push_back(i);
    }
  }
  if (bad.empty()) return;
  if (good.size() < kGoodPerBad * bad.size()) {
    normals.clear();
    return;
  }
  std::vector<Eigen::Vector3f> good_points;
  good_points.reserve(good.size());
  for (const std::uint32_t i : good) good_points.push_back(points[i]);
  const SpatialIndex index(good_points, context);
  std::vector<Neighbour> nearest;
  std::size_t repaired = 0;
  for (const std::uint32_t i : bad) {
    if (repaired++ % kStep == 0) context.check("sanitise");
    index.nearest(points[i], 1, nearest);
    normals[i] = normals[good[nearest[0].index]];
  }
}

CloudCounts sanitise(PointCloud& cloud, const RunContext& context) {
  check_lengths(cloud);
  CloudCounts counts;
  counts.points = cloud.size();
  const Reach reach = measure_reach(cloud.points);
  std::vector<std::uint32_t> kept;
  kept.reserve(cloud.size());
  for (std::uint32_t i = 0; i < cloud.size(); ++i) {
    if (i % kStep == 0) context.check("sanitise");
    const Eigen::Vector3f& p = cloud.points[i];
    if (reach.holds(p)) {
      kept.push_back(i);
    } else {
      ++(p.allFinite() ? counts.out_of_range : counts.not_finite);
    }
  }
  counts.duplicates = drop_repeats(cloud.points, kept, context);
  counts.out_of_range += drop_far_alone(cloud.points, reach, kept, context);
  counts.used = kept.size();
  keep_points(cloud, kept);
  repair_normals(cloud, context);
  check_viewpoints(cloud);
  cloud.width = 0;
  cloud.height = 0;
  return counts;
}

CloudCounts BlockSanitiser::sanitise(PointCloud& block, const RunContext& context) {
  check_lengths(block);
  CloudCounts counts;
  counts.points = block.size();
  std::vector<std::uint32_t> kept;
  kept.reserve(block.size());
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    if (i % kStep == 0) context.check("sanitise");
    if (block.points[i].allFinite()) kept.push_back(i);
  }
  counts.not_finite = block.size() - kept.size();
  // First, as a scanner may write zeros for every beam that met nothing: they are no bulk.
  counts.duplicates = drop_repeats(block.points, kept, context);
  add_to_sample(block.points, kept);
  const Reach reach = measure_reach(sample_);
  counts.out_of_range =
      std::erase_if(kept, [&](std::uint32_t i) { return !reach.holds(block.points[i]); });
  counts.used = kept.size();
  keep_points(block, kept);
  for (Eigen::Vector3f& normal : block.normals) {
    normal = is_unit(normal) ? Eigen::Vector3f(normal.normalized()) : Eigen::Vector3f::Zero();
  }
  check_viewpoints(block);
  block.width = 0;
  block.height = 0;
  return counts;
}

void BlockSanitiser::add_to_sample(const std::vector<Eigen::Vector3f>& points,
                                   const std::vector<std::uint32_t>& kept) {
  constexpr std::size_t kOfABlock = 1000;  // some ten blocks have what a median needs
  const std::size_t step = kept.size() / kOfABlock + 1;
  for (std::size_t k = 0; k < kept.size(); k += step) sample_.push_back(points[kept[k]]);
}

}  // namespace landmarkdb
