#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb {

// Drops every point that is not finite, repeats an earlier position exactly, or lies so far from
// the bulk (beyond 3,000 times the bulk's own extent, at least 100 m) that no scan can have made
// it, or far off and alone (drop_far_alone); the order of the rest is kept, the cloud is no longer
// organised. Normals are made exactly unit; the few that are not finite or not of unit length
// within 10 % take the nearest good one, and with more than a tenth of them bad all are dropped
// (the estimator makes new ones). Viewpoints that are not finite, or a point's number of one that
// is not there, drop the viewpoints. Returns what was counted. Throws Error{kInvalidArgument} when
// the arrays differ in length, and what `context.check` does; the cloud is then of no use.
CloudCounts sanitise(PointCloud& cloud, const RunContext& context = {});

// The same for the blocks of one scan, in their order, of which no two need be in memory together:
// repeats are those within a block; what is too far away is judged by this block and those before,
// each position once, and what is far off and alone stays; normals that are not of unit length
// become zero, for repair_normals to mend when all blocks are in one cloud. The blocks have one
// origin. Not thread-safe.
class BlockSanitiser {
 public:
  CloudCounts sanitise(PointCloud& block, const RunContext& context = {});

 private:
  void add_to_sample(const std::vector<Eigen::Vector3f>& points,
                     const std::vector<std::uint32_t>& kept);

  std::vector<Eigen::Vector3f> sample_;  // of all blocks so far
};

// Adds what was counted of a part to the sum.
void add_counts(CloudCounts& sum, const CloudCounts& part);

// What sanitise does to the normals. Throws what `context.check` does.
void repair_normals(PointCloud& cloud, const RunContext& context = {});

}  // namespace landmarkdb
