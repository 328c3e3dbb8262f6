#include "engine/retrieval/contrast.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "engine/base/parallel.hpp"
#include "engine/registration/plane_pairs.hpp"

namespace landmarkdb {

namespace {

// How well each of the points lies on the entry's surface under the pose, 0..1.
std::vector<float> fits_of(const PointGroups& points,
                           const Entry& entry,
                           const Eigen::Isometry3d& T_entry_sensor,
                           double tolerance_m) {
  const auto sigma = static_cast<float>(tolerance_m);
  std::vector<float> fits(points.groups() * PointGroups::kLanes);
  if (fits.empty()) return fits;
  pair_kernels().fits(
      entry.grid,
      points.group(0),
      points.groups(),
      {T_entry_sensor.linear().cast<float>(), T_entry_sensor.translation().cast<float>()},
      -0.5F / (sigma * sigma),
      fits.data());
  fits.resize(points.size());
  return fits;
}

// How closely the points of the view that proposed the pose lie on its entry's surface, 0..1.
double closeness_of(const SearchInput& input, const PointGroups& points, const Assessed& pose) {
  constexpr double kClose = 0.4;  // of the tolerance: a third of a voxel tells a slide of one voxel
  const Entry& entry = input.entries[pose.entry];
  const std::vector<float> fits =
      fits_of(points, entry, pose.T_entry_sensor, kClose * common_tolerance_m(input, entry));
  double sum = 0.0;
  for (const float fit : fits) sum += static_cast<double>(fit);
  return fits.empty() ? 0.0 : sum / static_cast<double>(fits.size());
}

// Of one pose, for each of the points: how well it lies on the entry's surface, 0..1, and 1 where
// it is known what is there; 0 where the entry was never scanned.
struct OfPose {
  std::vector<float> fits;
  std::vector<float> known;
};

std::vector<float> known_of(std::span<const Eigen::Vector3f> points,
                            const Entry& entry,
                            const Eigen::Isometry3d& T_entry_sensor) {
  std::vector<float> known(points.size(), 1.0F);
  if (!entry.scanned.known()) return known;
  const Eigen::Isometry3f T = T_entry_sensor.cast<float>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = T * points[i];
    if (entry.grid.near(p) == nullptr && !entry.scanned.is_empty_at(p)) known[i] = 0.0F;
  }
  return known;
}

// What the points that lie in scanned space under both poses say for one of them.
float contrast_of(const OfPose& mine, const OfPose& other) {
  // As if this share of the points had been undecided: what a handful of points says is no proof.
  constexpr float kUndecided = 0.02F;
  // Sums side by side, which a compiler lays into lanes.
  constexpr std::size_t kLanes = 16;
  std::array<float, kLanes> leads{};  // of mine less those of the other
  std::array<float, kLanes> sizes{};
  const std::size_t points = mine.fits.size();
  for (std::size_t first = 0; first < points; first += kLanes) {
    const std::size_t count = std::min(kLanes, points - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const std::size_t i = first + lane;
      const float lead = (mine.fits[i] - other.fits[i]) * (mine.known[i] * other.known[i]);
      leads[lane] += lead;
      sizes[lane] += std::abs(lead);
    }
  }
  float lead = 0.0F;
  float all = kUndecided * static_cast<float>(points);
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    lead += leads[lane];
    all += sizes[lane];
  }
  return all > 0.0F ? lead / all : 0.0F;
}

}  // namespace

void contrast_poses(const SearchInput& input, SearchResult& result) {
  std::vector<Assessed>& poses = result.poses;
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].id = i;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!input.entries[poses[i].entry].is_object()) places.push_back(i);
  }
  struct OfView {
    PointGroups points;
    std::vector<OfPose> poses;  // as `places`
  };
  std::map<const QueryView*, OfView> views;
  for (const std::size_t i : places) {
    const QueryView& view = *result.matches[poses[i].matches].view;
    OfView& of_view = views[&view];
    if (!of_view.poses.empty()) continue;
    of_view.points = PointGroups(view.sample_points, view.sample_normals);
    of_view.poses.resize(places.size());
  }
  for (auto& [view, of_view] : views) {
    parallel_chunks(places.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        input.context.check("verify");
        const Assessed& pose = poses[places[k]];
        const Entry& entry = input.entries[pose.entry];
        of_view.poses[k] = {
            fits_of(of_view.points, entry, pose.T_entry_sensor, common_tolerance_m(input, entry)),
            known_of(view->sample_points, entry, pose.T_entry_sensor)};
      }
    });
  }
  parallel_chunks(places.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      input.context.check("verify");
      Assessed& pose = poses[places[k]];
      const OfView& of_view = views.at(result.matches[pose.matches].view);
      pose.closeness = closeness_of(input, of_view.points, pose);
      pose.contrast.assign(poses.size(), 0.0F);
      for (std::size_t b = 0; b < places.size(); ++b) {
        pose.contrast[places[b]] = contrast_of(of_view.poses[k], of_view.poses[b]);
      }
    }
  });
}

}  // namespace landmarkdb
