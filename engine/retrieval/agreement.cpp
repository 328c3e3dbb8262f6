#include "engine/retrieval/agreement.hpp"

#include <cstdint>
#include <vector>

#include "engine/base/parallel.hpp"

namespace landmarkdb {

namespace {

double agreeing_keypoints(const EntryMatches& matches, const Entry& entry, const Assessed& pose) {
  const DescriptorSet& query = matches.view->descriptors;
  const DescriptorSet& target = entry.record().descriptors;
  const Eigen::Matrix3f R = pose.T_entry_sensor.linear().cast<float>();
  const Eigen::Vector3f t = pose.T_entry_sensor.translation().cast<float>();
  const auto inlier_m = static_cast<float>(kInlierCells) * entry.grid.cell_m();
  std::vector<char> agrees(query.size(), 0);
  std::uint32_t count = 0;
  for (const Correspondence& pair : matches.putative) {
    if (agrees[pair.query] != 0) continue;
    const Eigen::Vector3f there = R * query.keypoints[pair.query] + t;
    if ((there - target.keypoints[pair.target]).squaredNorm() > inlier_m * inlier_m) continue;
    agrees[pair.query] = 1;
    ++count;
  }
  return count;
}

}  // namespace

void count_agreeing(const SearchInput& input, SearchResult& result) {
  parallel_chunks(
      result.poses.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          input.context.check("verify");
          Assessed& pose = result.poses[i];
          const Entry& entry = input.entries[pose.entry];
          pose.evidence.agreeing = agreeing_keypoints(result.matches[pose.matches], entry, pose);
        }
      });
}

}  // namespace landmarkdb
