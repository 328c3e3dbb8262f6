#include "engine/retrieval/expected.hpp"

#include <algorithm>
#include <iterator>

namespace landmarkdb {

bool agrees_with_up(const Assessed& pose, const SceneRecord& record, const QueryOptions& options) {
  const std::optional<Gravity> gravity = gravity_of(options, record);
  if (!gravity) return true;
  const Eigen::Vector3f up = pose.T_entry_sensor.linear().cast<float>() * gravity->up_source;
  return up.dot(gravity->up_target) >= gravity->min_cosine;
}

bool agrees_with_prior(const Assessed& pose,
                       const SceneRecord& record,
                       const CleanQuery& query,
                       const QueryOptions& options) {
  if (!options.prior_T_scene_sensor) return true;
  return (sensor_position(pose, record, query) - options.prior_T_scene_sensor->translation())
             .norm() <= options.prior_radius_m;
}

Eigen::Vector3d sensor_position(const Assessed& pose,
                                const SceneRecord& record,
                                const CleanQuery& query) {
  return pose.T_entry_sensor * Eigen::Vector3d(-query.cloud.origin) + record.prepared.origin;
}

std::vector<Assessed> keep_expected(const SearchInput& input, std::vector<Assessed>& poses) {
  const auto first_dropped =
      std::stable_partition(poses.begin(), poses.end(), [&](const Assessed& pose) {
        const SceneRecord& record = input.entries[pose.entry].record();
        return agrees_with_up(pose, record, input.options) &&
               agrees_with_prior(pose, record, input.query, input.options);
      });
  std::vector<Assessed> dropped(std::make_move_iterator(first_dropped),
                                std::make_move_iterator(poses.end()));
  poses.erase(first_dropped, poses.end());
  return dropped;
}

}  // namespace landmarkdb
