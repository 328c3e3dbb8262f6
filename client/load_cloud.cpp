#include "client/load_cloud.hpp"

#include <algorithm>
#include <cstddef>

#include "cli/usage_error.hpp"
#include "client/choices.hpp"
#include "engine/base/error.hpp"
#include "engine/cloud/depth_image.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/geometry/camera.hpp"

namespace landmarkdb::client {
namespace {

Units units_of(const std::string& name) {
  if (name == "mm") return Units::kMillimetres;
  if (name == "cm") return Units::kCentimetres;
  if (name == "inch") return Units::kInches;
  return Units::kMetres;
}

PointCloud read(const std::filesystem::path& path, const LoadOptions& options) {
  if (options.camera.empty()) return read_cloud(path, {.units = units_of(options.units)});
  if (options.units != "m") {
    throw cli::UsageError("--units", "a depth image has its unit in the camera file (depth_scale)");
  }
  return read_depth_image(path, read_camera(options.camera));
}

// Fewer points than fix a pose are a mistake, not a question: better said here, with the file's
// name.
void require_points(const std::filesystem::path& path, const PointCloud& cloud) {
  constexpr std::ptrdiff_t kFewest = 4;
  const std::ptrdiff_t usable = std::ranges::count_if(
      cloud.points, [](const Eigen::Vector3f& point) { return point.allFinite(); });
  if (usable >= kFewest) return;
  throw Error(ErrorCode::kInvalidArgument,
              path.string() + ": " + std::to_string(usable) + " usable points of " +
                  std::to_string(cloud.size()) + ", want at least " + std::to_string(kFewest));
}

}  // namespace

PointCloud load_cloud(const std::filesystem::path& path, const LoadOptions& options) {
  PointCloud cloud = read(path, options);
  require_points(path, cloud);
  if (options.viewpoint) {  // viewpoints are floats around the origin, as the points are
    const Eigen::Vector3d viewpoint_m = *options.viewpoint * metres_per(units_of(options.units));
    cloud.viewpoints = {(viewpoint_m - cloud.origin).cast<float>()};
    cloud.viewpoint_index.clear();
  }
  return cloud;
}

void check_one_each(const std::string& option, std::size_t values, std::size_t clouds) {
  if (values == 0 || values == clouds) return;
  throw cli::UsageError(option,
                        "given " + std::to_string(values) + " times for " + std::to_string(clouds) +
                            " clouds, want none or one a cloud");
}

}  // namespace landmarkdb::client
