#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "datasets/place.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::datasets {

// The paper's two places (Cocias, Grigorescu, Moldoveanu 2014): a temple chamber, a lobby.
inline constexpr std::size_t kPaperTemplePoints = 245'685;
inline constexpr std::size_t kPaperLobbyPoints = 2'798'245;

// A terrestrial laser scanner: turns once about z, a mirror sweeps from nadir to zenith.
struct ScannerOptions {
  std::size_t points = 500'000;  // in all stations together, exactly this many; 0: all rays' hits
  double step_rad = 0.005;       // between rays, where `points` is 0
  double lowest_rad = -1.05;     // elevation of the lowest ray: below stands the tripod
  double noise_m = 0.006;        // standard deviation along the ray; scanners have 5-10 mm
  double mixed_pixels = 0.15;    // share of rays beside a depth edge that report a range between
  double min_range_m = 0.4;
  double max_range_m = 60.0;
  double dropout = 0.002;  // share of rays that do not come back
  std::uint64_t seed = 1;
};

// What one station saw, in the station's own frame: its viewpoint is the origin.
struct StationScan {
  PointCloud cloud;
  Eigen::Isometry3d T_scene_station;
};

// Scans the place from all of its stations. The same for any number of threads.
//
// Throws Error{kInvalidArgument} when there is no station, or an option out of range, or when even
// a very fine step cannot return as many points as wanted.
std::vector<StationScan> scan_place(const Place& place,
                                    const ScannerOptions& options,
                                    const RunContext& context);

// All stations as one cloud in the scene frame; each point keeps the viewpoint it was seen from.
PointCloud merge_stations(const std::vector<StationScan>& scans);

}  // namespace landmarkdb::datasets
