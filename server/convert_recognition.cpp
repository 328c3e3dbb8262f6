#include "server/convert_recognition.hpp"

#include <cmath>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "server/check_field.hpp"

namespace landmarkdb {
namespace {

constexpr std::uint32_t kMostHypotheses = 100;
constexpr std::uint32_t kLargestSide = 100'000;  // pixels

double finite(double value, const std::string& field) {
  if (!std::isfinite(value))
    refuse(field, "is " + std::to_string(value) + ", want a finite number");
  return value;
}

std::uint32_t side(std::uint32_t value, const std::string& field) {
  if (value == 0 || value > kLargestSide) {
    refuse(field,
           "is " + std::to_string(value) + " pixels, want 1 to " + std::to_string(kLargestSide));
  }
  return value;
}

double focal_length(double value, const std::string& field) {
  if (!std::isfinite(value) || value == 0.0) {
    refuse(field, "is " + std::to_string(value) + ", want a focal length in pixels");
  }
  return value;
}

FeatureType type_from(v1::FeatureType type, const std::string& field) {
  switch (type) {
    case v1::FEATURE_TYPE_UNSPECIFIED:
    case v1::FEATURE_TYPE_VERTEX:
      return FeatureType::kVertex;
    case v1::FEATURE_TYPE_CONIC_CENTRE:
      return FeatureType::kConicCentre;
    case v1::FEATURE_TYPE_CENTROID:
      return FeatureType::kCentroid;
    case v1::FEATURE_TYPE_INFLEXION:
      return FeatureType::kInflexion;
    default:
      refuse(field, "no type of feature point has the number " + std::to_string(type));
  }
}

v1::MonoHypothesis to_proto(const MonoHypothesis& hypothesis) {
  v1::MonoHypothesis message;
  message.set_model(hypothesis.model);
  message.set_confidence(hypothesis.confidence);
  for (const double number : to_row_major(hypothesis.T_camera_object.matrix())) {
    message.add_t_camera_object(number);
  }
  for (Eigen::Index row = 0; row < 6; ++row) {
    for (Eigen::Index column = 0; column < 6; ++column) {
      message.add_covariance(hypothesis.covariance(row, column));
    }
  }
  message.set_model_points(static_cast<std::uint32_t>(hypothesis.model_points));
  message.set_visible_points(static_cast<std::uint32_t>(hypothesis.visible_points));
  message.set_rms_px(hypothesis.rms_px);
  message.set_log10_nfa(hypothesis.log10_nfa);
  message.set_edge_share(hypothesis.edge_share);
  message.set_margin(hypothesis.margin);
  message.set_symmetry(hypothesis.symmetry);
  message.set_ambiguous(hypothesis.ambiguous);
  for (const MonoPair& pair : hypothesis.pairs) {
    v1::MonoPair& added = *message.add_pairs();
    added.set_model(pair.model);
    added.set_image(pair.image);
    added.set_residual_px(pair.residual_px);
  }
  return message;
}

}  // namespace

Camera from_proto(const v1::Camera& message) {
  Camera camera;
  camera.width = side(message.width(), "camera.width");
  camera.height = side(message.height(), "camera.height");
  camera.fx = focal_length(message.fx(), "camera.fx");
  camera.fy = focal_length(message.fy(), "camera.fy");
  camera.cx = finite(message.cx(), "camera.cx");
  camera.cy = finite(message.cy(), "camera.cy");
  if (!message.dist().empty() && message.dist_size() != 5) {
    refuse("camera.dist", std::to_string(message.dist_size()) + " numbers, want none or 5");
  }
  for (int i = 0; i < message.dist_size(); ++i) {
    camera.dist[static_cast<std::size_t>(i)] = finite(message.dist(i), "camera.dist");
  }
  return camera;
}

RecognizeOptions from_proto(const v1::RecognizeOptions& message) {
  RecognizeOptions options;
  options.models.assign(message.models().begin(), message.models().end());
  if (message.has_top()) {
    if (message.top() == 0 || message.top() > kMostHypotheses) {
      refuse(
          "options.top",
          "is " + std::to_string(message.top()) + ", want 1 to " + std::to_string(kMostHypotheses));
    }
    options.top = message.top();
  }
  if (message.has_min_confidence()) {
    options.min_confidence = in_range(message.min_confidence(), 0.0, 1.0, "options.min_confidence");
  }
  constexpr double kNearest_m = 1e-6;
  constexpr double kFurthest_m = 1e6;
  if (message.has_min_depth_m()) {
    options.min_depth_m =
        in_range(message.min_depth_m(), kNearest_m, kFurthest_m, "options.min_depth_m");
  }
  if (message.has_max_depth_m()) {
    options.max_depth_m =
        in_range(message.max_depth_m(), kNearest_m, kFurthest_m, "options.max_depth_m");
  }
  if (options.min_depth_m >= options.max_depth_m) {
    refuse("options.max_depth_m",
           "is " + std::to_string(options.max_depth_m) + ", want more than min_depth_m, " +
               std::to_string(options.min_depth_m));
  }
  if (message.has_seed()) options.seed = message.seed();
  return options;
}

ImageFeatures from_proto(const v1::ImagePoints& message, const Camera& camera) {
  if (message.points_size() > kMaxImagePoints) {
    refuse("points",
           std::to_string(message.points_size()) + " points, want at most " +
               std::to_string(kMaxImagePoints));
  }
  if (message.links_size() % 2 != 0 || message.links_size() / 2 > kMaxImagePoints) {
    refuse("points.links",
           std::to_string(message.links_size()) + " numbers, want two a link and at most " +
               std::to_string(kMaxImagePoints) + " links");
  }
  ImageFeatures features;
  features.width = camera.width;
  features.height = camera.height;
  features.points.reserve(static_cast<std::size_t>(message.points_size()));
  for (int i = 0; i < message.points_size(); ++i) {
    const v1::ImagePoint& point = message.points(i);
    const std::string field = "points.points[" + std::to_string(i) + "]";
    constexpr int kMostDirections = 16;
    if (point.directions_rad_size() > kMostDirections) {
      refuse(field,
             std::to_string(point.directions_rad_size()) + " directions, want at most " +
                 std::to_string(kMostDirections));
    }
    ImageFeature feature;
    feature.type = type_from(point.type(), field + ".type");
    feature.uv = {finite(point.u(), field + ".u"), finite(point.v(), field + ".v")};
    for (const double direction : point.directions_rad()) {
      feature.directions.push_back(finite(direction, field + ".directions_rad"));
    }
    features.points.push_back(std::move(feature));
  }
  for (int i = 0; i < message.links_size(); i += 2) {
    const std::uint32_t a = message.links(i);
    const std::uint32_t b = message.links(i + 1);
    if (a >= features.points.size() || b >= features.points.size() || a == b) {
      refuse("points.links",
             "link " + std::to_string(i / 2) + " joins points " + std::to_string(a) + " and " +
                 std::to_string(b) + ", want two of the " + std::to_string(features.points.size()));
    }
    features.links.push_back({a, b});
  }
  return features;
}

v1::RecognizeResult to_proto(const RecognizeResult& result) {
  v1::RecognizeResult message;
  message.set_status(result.status == RecognizeStatus::kRecognized
                         ? v1::RECOGNIZE_STATUS_RECOGNIZED
                         : v1::RECOGNIZE_STATUS_NOT_FOUND);
  message.set_reason(result.reason);
  for (const MonoHypothesis& hypothesis : result.hypotheses) {
    *message.add_hypotheses() = to_proto(hypothesis);
  }
  message.set_image_points(result.image_points);
  message.set_seed(result.seed);
  for (const std::string& warning : result.warnings) message.add_warnings(warning);
  v1::RecognizeTimings& timing = *message.mutable_timing();
  timing.set_features_ms(result.timings.features.count());
  timing.set_lookup_ms(result.timings.lookup.count());
  timing.set_verify_ms(result.timings.verify.count());
  timing.set_refine_ms(result.timings.refine.count());
  timing.set_total_ms(result.timings.total.count());
  return message;
}

v1::ModelInfo to_proto(const ModelSummary& model, const std::string& quarantined) {
  const auto count = [&](FeatureType type) {
    return static_cast<std::uint32_t>(model.points_of_type[static_cast<std::size_t>(type)]);
  };
  v1::ModelInfo message;
  message.set_name(model.name);
  message.set_model_id(model.id);
  message.set_created(model.created);
  message.set_source(model.source);
  message.set_unit_scale(model.unit_scale);
  message.set_vertices(count(FeatureType::kVertex));
  message.set_conic_centres(count(FeatureType::kConicCentre));
  message.set_centroids(count(FeatureType::kCentroid));
  message.set_inflexions(count(FeatureType::kInflexion));
  message.set_edges(static_cast<std::uint32_t>(model.edges));
  message.set_faces(static_cast<std::uint32_t>(model.faces));
  message.set_circles(static_cast<std::uint32_t>(model.circles));
  message.set_triples(static_cast<std::uint32_t>(model.triples));
  message.set_symmetry(model.symmetry);
  message.set_symmetries(static_cast<std::uint32_t>(model.symmetries));
  message.set_diameter_m(model.diameter_m);
  for (const std::string& warning : model.warnings) message.add_warnings(warning);
  message.set_sha256(model.sha256);
  message.set_quarantined(model.damage ? *model.damage : quarantined);
  return message;
}

}  // namespace landmarkdb
