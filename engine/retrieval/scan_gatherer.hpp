#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/cloud/cloud_merger.hpp"
#include "engine/cloud/sanitise.hpp"
#include "engine/retrieval/index_options.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// All scans of a place as one cloud in its frame, sanitised.
struct GatheredScans {
  PointCloud cloud;
  CloudCounts counts;
  std::vector<std::string> sources;
  double cell_m = 0.0;  // the cloud was condensed to cells of this edge; 0: every point is there
};

// For messages: how many points there were, and what became of them.
std::string describe_counts(const CloudCounts& counts);

// Takes the scans of a place as they are read, block by block, and holds no more than a fixed
// number of points however many come (decision 26).
//
// Up to that number the scans are held as they are, and each is sanitised whole. From then on
// blocks are sanitised as they come and laid into the scene; whenever the number is passed, what is
// there is condensed to one point a cell, so that half of it is free again. Cells are as fine as
// that allows, from a sixteenth to half of the working voxel that the extent of what is there so
// far asks for; a surface so large that it does not fit into those is held in them all the same.
// Not thread-safe.
class ScanGatherer {
 public:
  static constexpr std::size_t kMostHeld = 12'000'000;  // 0.8 GB in all with normals and colours

  // `options` and `context` must outlive it; tests lower `most_held`.
  ScanGatherer(const IndexOptions& options,
               const RunContext& context,
               std::size_t most_held = kMostHeld)
      : options_(options), context_(context), most_held_(most_held), room_for_(most_held) {}

  // The blocks to read scans in.
  std::size_t block_points() const { return most_held_ / 8 + 1; }

  // The blocks that follow are of a scan from this file, with this pose in the scene frame.
  void begin_scan(std::string source, const Eigen::Isometry3d& T_scene_cloud);

  // The next points of the scan, in metres; all blocks of a scan have its origin and viewpoints.
  // Throws what sanitise, CloudMerger and condense do.
  void add(PointCloud block);

  // Reports the stage "sanitise", unless that was done on the way. Throws Error{kInvalidArgument}
  // with what was counted when fewer than four points are left. Afterwards the gatherer is of no
  // use.
  GatheredScans finish();

 private:
  struct HeldScan {
    Eigen::Isometry3d T_scene_cloud;
    PointCloud cloud;
  };

  GatheredScans finish_whole();
  void go_over_to_blocks();
  void lay_down(PointCloud block);
  void condense_what_is_there();

  const IndexOptions& options_;
  const RunContext& context_;
  std::size_t most_held_;
  std::size_t room_for_;  // points; more than `most_held_` where the surface is so large
  std::vector<std::string> sources_;
  CloudCounts counts_;

  std::vector<HeldScan> whole_;  // the last one may still grow
  bool in_blocks_ = false;       // `whole_` is empty, and the points are in the merger
  BlockSanitiser sanitiser_;     // of the scan that comes
  CloudMerger merger_;
  double cell_m_ = 0.0;
};

}  // namespace landmarkdb
