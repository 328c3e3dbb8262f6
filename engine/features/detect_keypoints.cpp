#include "engine/features/detect_keypoints.hpp"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/features/check_cloud.hpp"
#include "engine/features/iss_keypoints.hpp"
#include "engine/features/narf_keypoints.hpp"
#include "engine/features/structure_keypoints.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "keypoints";
constexpr double kIssSalientResolutions = 6.0;  // the radii of PCL's own example
constexpr double kIssNmsResolutions = 4.0;

Keypoints structured(const PreparedCloud& cloud,
                     const KeypointOptions& options,
                     const RunContext& context) {
  if (!std::isfinite(options.min_structure)) {
    throw Error(ErrorCode::kInvalidArgument,
                "least structure is " + std::to_string(options.min_structure) +
                    ", want a number from 0 to 0.5");
  }
  const Keypoints candidates = uniform_keypoints(cloud, options.spacing_m);
  const std::vector<float> spread =
      normal_spread(cloud, candidates, options.structure_radius_m, context);
  Keypoints kept;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (static_cast<double>(spread[i]) > options.min_structure) {
      kept.index.push_back(candidates.index[i]);
    }
  }
  return kept;
}

Keypoints detect(const PreparedCloud& cloud,
                 const KeypointOptions& options,
                 const RunContext& context) {
  switch (options.method) {
    case KeypointMethod::kUniform:
      check_length(options.spacing_m, "keypoint spacing");
      return uniform_keypoints(cloud, options.spacing_m);
    case KeypointMethod::kStructure:
      check_length(options.spacing_m, "keypoint spacing");
      check_length(options.structure_radius_m, "structure radius");
      return structured(cloud, options, context);
    case KeypointMethod::kIss:
      check_length(cloud.resolution_m, "cloud resolution");
      return iss_keypoints(cloud,
                           {.salient_radius_m = kIssSalientResolutions * cloud.resolution_m,
                            .nms_radius_m = kIssNmsResolutions * cloud.resolution_m},
                           context);
    case KeypointMethod::kNarf:
      check_length(options.structure_radius_m, "structure radius");
      check_length(cloud.resolution_m, "cloud resolution");
      return narf_keypoints(cloud, options.structure_radius_m, context);
  }
  throw Error(ErrorCode::kInvalidArgument,
              "keypoint method " + std::to_string(static_cast<int>(options.method)) +
                  " is not one of uniform, structure, iss, narf");
}

}  // namespace

Keypoints detect_keypoints(const PreparedCloud& cloud,
                           const KeypointOptions& options,
                           const RunContext& context) {
  check_cloud(cloud, kStage);
  context.report(kStage, 0, cloud.size());
  Keypoints result = detect(cloud, options, context);
  context.report(kStage, cloud.size(), cloud.size());
  return result;
}

}  // namespace landmarkdb
