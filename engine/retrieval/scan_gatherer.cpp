#include "engine/retrieval/scan_gatherer.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <sstream>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/cloud/merge_clouds.hpp"
#include "engine/cloud/resolution.hpp"
#include "engine/cloud/voxel_grid.hpp"
#include "engine/retrieval/feature_options.hpp"

namespace landmarkdb {
namespace {

// Cells across a working voxel, powers of two, so that voxels are made of whole cells.
constexpr double kFinestCells = 16.0;   // 3 mm at 5 cm: a scanner's noise
constexpr double kCoarsestCells = 2.0;  // coarser ones would shift what is seen of a voxel

template <typename T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// `block` behind `cloud`, of which it is the next part.
void append(PointCloud& cloud, PointCloud block) {
  if (cloud.empty()) {
    cloud = std::move(block);
    return;
  }
  append(cloud.points, block.points);
  append(cloud.normals, block.normals);
  append(cloud.colours, block.colours);
  append(cloud.viewpoint_index, block.viewpoint_index);
}

// What the place would be described at if it were as large as this part of it and its points as
// close as one could wish: no more than what it will be described at.
double finest_voxel(const PointCloud& part,
                    const IndexOptions& options,
                    const RunContext& context) {
  constexpr double kLeast_m = 1e-6;  // what lies in one spot has no extent
  const CloudScale scale{.extent_m = measure_extent(part, context)};
  const double voxel_m =
      derive_feature_options(scale, options.kind, options.keypoints, options.voxel_m, {}).voxel_m;
  return std::isfinite(voxel_m) ? std::max(kLeast_m, voxel_m) : kLeast_m;
}

void check_enough(const CloudCounts& counts) {
  constexpr std::size_t kFewest = 4;  // a similarity needs four pairs
  if (counts.used >= kFewest) return;
  throw Error(ErrorCode::kInvalidArgument,
              "nothing to describe: " + describe_counts(counts) + ", want at least 4");
}

}  // namespace

std::string describe_counts(const CloudCounts& counts) {
  std::ostringstream text;
  text << counts.points << " points, " << counts.not_finite << " not finite, " << counts.duplicates
       << " repeated, " << counts.out_of_range << " out of range, " << counts.used << " left";
  return text.str();
}

void ScanGatherer::begin_scan(std::string source, const Eigen::Isometry3d& T_scene_cloud) {
  sources_.push_back(std::move(source));
  if (!in_blocks_) {
    whole_.push_back({T_scene_cloud, {}});
    return;
  }
  sanitiser_ = {};
  merger_.begin_scan(T_scene_cloud);
}

void ScanGatherer::add(PointCloud block) {
  assert(!sources_.empty() && "a scan begins before its points come");
  context_.check("sanitise");
  if (!in_blocks_) {
    counts_.points += block.size();
    append(whole_.back().cloud, std::move(block));
    if (counts_.points > most_held_) go_over_to_blocks();
    return;
  }
  lay_down(std::move(block));
}

void ScanGatherer::go_over_to_blocks() {
  in_blocks_ = true;
  counts_ = {};
  for (HeldScan& scan : std::exchange(whole_, {})) {
    sanitiser_ = {};
    merger_.begin_scan(scan.T_scene_cloud);
    lay_down(std::exchange(scan.cloud, {}));
  }
}

void ScanGatherer::lay_down(PointCloud block) {
  add_counts(counts_, sanitiser_.sanitise(block, context_));
  // A scan that came whole may be larger than a block; vectors that grow would hold it twice.
  merger_.reserve(std::max(room_for_ + block_points(), merger_.cloud().size() + block.size()));
  merger_.append(block, context_);
  block = {};
  if (merger_.cloud().size() > room_for_) condense_what_is_there();
}

void ScanGatherer::condense_what_is_there() {
  PointCloud& cloud = merger_.cloud();
  const double voxel_m = finest_voxel(cloud, options_, context_);
  if (cell_m_ == 0.0) cell_m_ = voxel_m / kFinestCells;
  condense(cloud, cell_m_, context_);
  while (cloud.size() > most_held_ / 2 && kCoarsestCells * 2.0 * cell_m_ <= voxel_m) {
    cell_m_ *= 2.0;
    condense(cloud, cell_m_, context_);
  }
  room_for_ = std::max(most_held_, 2 * cloud.size());
}

GatheredScans ScanGatherer::finish() {
  if (!in_blocks_) return finish_whole();
  check_enough(counts_);
  GatheredScans gathered{merger_.finish(), counts_, std::move(sources_), cell_m_};
  repair_normals(gathered.cloud, context_);
  return gathered;
}

GatheredScans ScanGatherer::finish_whole() {
  counts_ = {};
  std::vector<PointCloud> clouds;
  std::vector<Eigen::Isometry3d> T_scene_cloud;
  for (std::size_t i = 0; i < whole_.size(); ++i) {
    context_.report("sanitise", i, whole_.size());
    PointCloud& cloud = whole_[i].cloud;
    add_counts(counts_, sanitise(cloud, context_));
    if (cloud.empty()) continue;
    clouds.push_back(std::move(cloud));
    T_scene_cloud.push_back(whole_[i].T_scene_cloud);
  }
  check_enough(counts_);
  const bool as_it_is =
      clouds.size() == 1 && T_scene_cloud[0].isApprox(Eigen::Isometry3d::Identity());
  return {as_it_is ? std::move(clouds[0]) : merge_clouds(clouds, T_scene_cloud, context_),
          counts_,
          std::move(sources_)};
}

}  // namespace landmarkdb
