#include "engine/retrieval/scene_view.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include "engine/cloud/voxel_grid.hpp"

namespace landmarkdb {

namespace {

Eigen::AlignedBox3f padded_box(const Assessed& pose,
                               const CleanQuery& query,
                               const EntryMatches& matches) {
  constexpr float kLeastPad_m = 1.0F;
  const Eigen::Isometry3f T = pose.T_entry_sensor.cast<float>();
  Eigen::AlignedBox3f box(T * query.cloud.viewpoints[0]);
  for (const Eigen::Vector3f& point : matches.view->sample_points) box.extend(T * point);
  const float pad = std::max(kLeastPad_m, 0.5F * box.diagonal().norm());
  return {box.min().array() - pad, box.max().array() + pad};
}

// One point a voxel, the voxel as small as the number allows; points that not even one voxel over
// all of them brings down to it (the grid may part them) are cut off.
void thin_to(std::uint32_t most, SceneView& view) {
  constexpr double kStep = 1.15;  // a third fewer points of a surface a step
  if (view.points.size() <= most) return;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : view.points) box.extend(point);
  const auto whole_m = static_cast<double>(box.diagonal().norm());
  PointCloud all;
  all.points = view.points;
  while (view.points.size() > most && view.spacing_m < whole_m) {
    const double share = static_cast<double>(view.points.size()) / most;
    view.spacing_m *= std::max(kStep, 0.9 * std::sqrt(share));
    view.points = thin(all, view.spacing_m).points;
  }
  if (view.points.size() > most) view.points.resize(most);
}

}  // namespace

SceneView make_scene_view(const Judged& judged,
                          const SearchInput& input,
                          const SearchResult& search,
                          std::uint32_t most) {
  const Entry& entry = input.entries[judged.pose.entry];
  const PreparedCloud& cloud = entry.record().prepared;
  SceneView view;
  view.origin = cloud.origin;
  view.scene_points = cloud.size();
  view.spacing_m = cloud.resolution_m;
  view.up = entry.record().up;
  if (entry.is_object()) {
    view.points = cloud.points;
  } else {
    const Eigen::AlignedBox3f box =
        padded_box(judged.pose, input.query, search.matches[judged.pose.matches]);
    std::copy_if(cloud.points.begin(),
                 cloud.points.end(),
                 std::back_inserter(view.points),
                 [&](const Eigen::Vector3f& point) { return box.contains(point); });
  }
  view.whole = view.points.size() == cloud.size();
  thin_to(std::max(most, 1U), view);
  return view;
}

}  // namespace landmarkdb
