#include "engine/mono/mirror_rival.hpp"

#include <vector>

namespace landmarkdb {

SearchModel prepare_mirror(const MonoModelRecord& record, const SearchTables& tables) {
  auto mirror = std::make_shared<MonoModelRecord>();
  mirror->model = mirror_image(record.model);
  SearchTables mirror_tables;  // nothing is looked up by its quads
  mirror_tables.seen = tables.mirror_seen;
  return prepare_model(mirror, mirror_tables);
}

RigidPose mirror_pose(const SearchModel& model, const RigidPose& pose) {
  const Eigen::Vector3d eye = -(pose.R.transpose() * pose.t);
  const Eigen::Vector3d sight = (eye - model.center).normalized();
  const Eigen::Matrix3d S = Eigen::Matrix3d::Identity() - 2.0 * sight * sight.transpose();
  Eigen::Matrix3d to_mirror = S;
  to_mirror.col(0) = -to_mirror.col(0);  // the mirror image's points are x -> -x already
  return {pose.R * to_mirror, pose.R * (model.center - S * model.center) + pose.t};
}

std::optional<double> mirror_margin(const SearchModel& model,
                                    const MonoCandidate& candidate,
                                    PoseCheck& mirrors) {
  const RigidPose start = mirror_pose(model, candidate.pose);
  const std::span<const Match> found = mirrors.look(candidate.model, start);
  if (found.empty()) return std::nullopt;
  const std::vector<Match> matches(found.begin(), found.end());
  std::optional<MonoCandidate> mirror = mirrors.settle(candidate.model, start, matches);
  if (!mirror) return std::nullopt;
  mirrors.settle_on_edges(*mirror);
  return mirror->rank() - candidate.rank();
}

}  // namespace landmarkdb
