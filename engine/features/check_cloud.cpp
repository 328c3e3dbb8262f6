#include "engine/features/check_cloud.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorCode::kInvalidArgument, message);
}

}  // namespace

void check_cloud(const PreparedCloud& cloud, std::string_view stage) {
  const std::string name(stage);
  if (cloud.normals.size() != cloud.points.size()) {
    refuse(name + ": cloud has " + std::to_string(cloud.normals.size()) + " normals for " +
           std::to_string(cloud.points.size()) + " points, want one each");
  }
  if (cloud.points.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    refuse(name + ": cloud has " + std::to_string(cloud.points.size()) +
           " points, want fewer than 2^31");
  }
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.points[i].allFinite() || !cloud.normals[i].allFinite()) {
      refuse(name + ": point " + std::to_string(i) +
             " or its normal is not finite, want a sanitised cloud");
    }
  }
}

void check_length(double length_m, std::string_view name) {
  if (!(length_m > 0.0) || !std::isfinite(length_m)) {
    refuse(std::string(name) + " is " + std::to_string(length_m) + " m, want a positive number");
  }
}

}  // namespace landmarkdb
