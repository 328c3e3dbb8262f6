#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "engine/types/point_cloud.hpp"

namespace landmarkdb::client {

// How a file named on the command line is to be read.
struct LoadOptions {
  std::string units = "m";                   // "m", "mm", "cm" or "inch"
  std::string camera;                        // a camera file: the input is a depth image; or empty
  std::optional<Eigen::Vector3d> viewpoint;  // the cloud's own frame and units; replaces the file's
};

// Reads a cloud, mesh or depth image. Throws Error{kInvalidArgument} naming the file, also when
// fewer than four of its points are finite.
PointCloud load_cloud(const std::filesystem::path& path, const LoadOptions& options);

// Refuses an option that is given neither never nor once for each cloud (cli::UsageError).
void check_one_each(const std::string& option, std::size_t values, std::size_t clouds);

}  // namespace landmarkdb::client
