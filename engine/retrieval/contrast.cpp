#include "engine/retrieval/contrast.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "engine/base/parallel.hpp"
#include "engine/registration/pose_score.hpp"

namespace landmarkdb {

namespace {

// How well each of the view's sample points lies on the entry's surface under the pose, 0..1.
std::vector<float> fits_of(const QueryView& view,
                           const Entry& entry,
                           const Eigen::Isometry3d& T_entry_sensor,
                           double tolerance_m) {
  const Eigen::Matrix3f R = T_entry_sensor.linear().cast<float>();
  const Eigen::Vector3f t = T_entry_sensor.translation().cast<float>();
  const auto sigma = static_cast<float>(tolerance_m);
  const float factor = -0.5F / (sigma * sigma);
  std::vector<float> fits(view.sample_points.size(), 0.0F);
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const Eigen::Vector3f p = R * view.sample_points[i] + t;
    fits[i] = surface_fit(entry.grid, p, R * view.sample_normals[i], factor);
  }
  return fits;
}

// How closely the points of the view that proposed the pose lie on its entry's surface, 0..1.
double closeness_of(const SearchInput& input, const SearchResult& result, const Assessed& pose) {
  constexpr double kClose = 0.4;  // of the tolerance: a third of a voxel tells a slide of one voxel
  const Entry& entry = input.entries[pose.entry];
  const std::vector<float> fits = fits_of(*result.matches[pose.matches].view,
                                          entry,
                                          pose.T_entry_sensor,
                                          kClose * common_tolerance_m(input, entry));
  double sum = 0.0;
  for (const float fit : fits) sum += static_cast<double>(fit);
  return fits.empty() ? 0.0 : sum / static_cast<double>(fits.size());
}

float contrast_of(const std::vector<float>& mine, const std::vector<float>& other) {
  // As if this share of the points had been undecided: what a handful of points says is no proof.
  constexpr float kUndecided = 0.02F;
  float for_mine = 0.0F;
  float against = 0.0F;
  for (std::size_t i = 0; i < mine.size(); ++i) {
    const float difference = mine[i] - other[i];
    (difference > 0.0F ? for_mine : against) += std::abs(difference);
  }
  const float undecided = kUndecided * static_cast<float>(mine.size());
  const float all = for_mine + against + undecided;
  return all > 0.0F ? (for_mine - against) / all : 0.0F;
}

}  // namespace

void contrast_poses(const SearchInput& input, SearchResult& result) {
  std::vector<Assessed>& poses = result.poses;
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].id = i;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!input.entries[poses[i].entry].is_object()) places.push_back(i);
  }
  std::map<const QueryView*, std::vector<std::vector<float>>> fits;  // by view, then as `places`
  for (const std::size_t i : places) fits[result.matches[poses[i].matches].view];
  for (auto& [view, of_poses] : fits) {
    of_poses.resize(places.size());
    parallel_chunks(places.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        input.context.check("verify");
        const Assessed& pose = poses[places[k]];
        const Entry& entry = input.entries[pose.entry];
        of_poses[k] = fits_of(*view, entry, pose.T_entry_sensor, common_tolerance_m(input, entry));
      }
    });
  }
  parallel_chunks(places.size(), input.context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      input.context.check("verify");
      poses[places[k]].closeness = closeness_of(input, result, poses[places[k]]);
    }
  });
  for (std::size_t a = 0; a < places.size(); ++a) {
    Assessed& pose = poses[places[a]];
    const auto& of_poses = fits.at(result.matches[pose.matches].view);
    pose.contrast.assign(poses.size(), 0.0F);
    for (std::size_t b = 0; b < places.size(); ++b) {
      pose.contrast[places[b]] = contrast_of(of_poses[a], of_poses[b]);
    }
  }
}

}  // namespace landmarkdb
