#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"

namespace landmarkdb::bench {

// Generated places, small ones, one storey each, of all types in turn.
struct SiteOptions {
  std::uint64_t seed = 10'000;  // of place 0; place i takes seed + i
  std::size_t points = 20'000;  // of each scan
  double size = 0.5;            // datasets::PlaceOptions::size
};

// "place-0007": a place's name does not depend on how many there are.
std::string place_name(std::size_t number);

// Scans and describes the places that a database lacks of the first `places` and stores them; the
// file is made where there is none. A run that was interrupted can be taken up. Stops after
// `most_seconds`. Returns how many of them it holds then. Throws what the generator and the store
// throw, and Error{kInvalidArgument} where the file holds other scenes.
std::size_t fill_database(const std::string& path,
                          const SiteOptions& options,
                          std::size_t places,
                          double most_seconds,
                          const RunContext& context);

// A depth frame taken in one of the places, thinned at random, and where it was taken.
struct SiteFrame {
  std::string place;
  PointCloud cloud;  // camera frame
  Eigen::Isometry3d T_scene_camera = Eigen::Isometry3d::Identity();
};

// `count` frames of the first `places` places in turn, of `points` points each (fewer where the
// camera saw fewer; 0: all it saw). Same options, same frames.
std::vector<SiteFrame> take_frames(const SiteOptions& options,
                                   std::size_t places,
                                   std::size_t count,
                                   std::size_t points,
                                   const RunContext& context);

}  // namespace landmarkdb::bench
