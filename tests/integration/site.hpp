#pragma once

#include <cstdint>
#include <string>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "tests/integration/programs.hpp"
#include "tests/support/make_scene.hpp"

namespace landmarkdb::testing {

// Stores the scans of a made-up room under a name, through the indexer's command line.
Outcome index_scene(const TempFolder& folder,
                    const std::string& db,
                    const std::string& name,
                    const SyntheticScene& scene);

// A room with so few points that it is described in a moment.
SyntheticScene make_small_room(std::uint64_t seed);

// A database with the room of seed 1, "room", and clouds to ask about; made once a process.
struct Site {
  Site();

  // Writes what a camera there sees; returns the file's path.
  std::string view(const std::string& name,
                   const SyntheticScene& scene,
                   const Eigen::Isometry3d& T_scene_sensor) const;

  TempFolder folder;
  std::string db;
  SyntheticScene room;       // stored
  SyntheticScene elsewhere;  // not stored
};
const Site& site();

// The 16 numbers as a matrix.
Eigen::Matrix4d matrix(const nlohmann::json& numbers);

}  // namespace landmarkdb::testing
