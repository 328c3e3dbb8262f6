#include "engine/retrieval/agreement.hpp"

#include <algorithm>
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
  std::vector<Eigen::Vector3f> there(query.size());
  for (std::size_t i = 0; i < query.size(); ++i) there[i] = R * query.keypoints[i] + t;
  std::vector<char> agrees(query.size(), 0);
  for (const Correspondence& pair : matches.putative) {
    const Eigen::Vector3f apart = there[pair.query] - target.keypoints[pair.target];
    if (apart.squaredNorm() <= inlier_m * inlier_m) agrees[pair.query] = 1;
  }
  return static_cast<double>(std::count(agrees.begin(), agrees.end(), 1));
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
