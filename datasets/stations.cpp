#include "datasets/stations.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "datasets/sensor_poses.hpp"
#include "datasets/shapes/shapes.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr double kTripod_m = 1.6;
constexpr std::size_t kCandidates = 120;

// Floors are surveyed alike: candidates are drawn on the lowest one and carried up.
std::vector<Eigen::Isometry3d> candidates_on(const Place& place, int floor) {
  const PoseSampling sampling{.lowest_eye_m = kTripod_m - 0.05,
                              .highest_eye_m = kTripod_m + 0.05,
                              .clearance_m = 0.45,
                              .floor = floor};
  return sample_upright_poses(place, kCandidates, place.options.seed + 77, sampling);
}

// Greedily the candidate that is furthest from all chosen ones.
std::vector<Eigen::Isometry3d> spread(const std::vector<Eigen::Isometry3d>& candidates,
                                      std::size_t wanted) {
  std::vector<Eigen::Isometry3d> chosen;
  std::vector<double> distance(candidates.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (chosen.size() < std::min(wanted, candidates.size())) {
    chosen.push_back(candidates[next]);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      distance[i] =
          std::min(distance[i], (candidates[i].translation() - chosen.back().translation()).norm());
    }
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) -
                                    distance.begin());
  }
  return chosen;
}

}  // namespace

std::vector<Eigen::Isometry3d> choose_stations(const Place& place) {
  std::vector<Eigen::Isometry3d> stations;
  for (int floor = 0; floor < place.options.floors; ++floor) {
    const auto chosen =
        spread(candidates_on(place, floor), static_cast<std::size_t>(place.options.stations));
    stations.insert(stations.end(), chosen.begin(), chosen.end());
  }
  return stations;
}

}  // namespace landmarkdb::datasets
