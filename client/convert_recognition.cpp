#include "client/convert_recognition.hpp"

#include <span>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::kInternal, "the server's answer is not as it should be: " + what);
}

v1::FeatureType to_proto(FeatureType type) {
  switch (type) {
    case FeatureType::kVertex:
      return v1::FEATURE_TYPE_VERTEX;
    case FeatureType::kConicCentre:
      return v1::FEATURE_TYPE_CONIC_CENTRE;
    case FeatureType::kCentroid:
      return v1::FEATURE_TYPE_CENTROID;
    case FeatureType::kInflexion:
      return v1::FEATURE_TYPE_INFLEXION;
  }
  return v1::FEATURE_TYPE_UNSPECIFIED;
}

MonoHypothesis from_proto(const v1::MonoHypothesis& message) {
  if (message.t_camera_object_size() != 16 || message.covariance_size() != 36) {
    refuse("a pose of " + std::to_string(message.t_camera_object_size()) +
           " numbers, or a covariance of " + std::to_string(message.covariance_size()));
  }
  MonoHypothesis hypothesis;
  hypothesis.model = message.model();
  hypothesis.confidence = message.confidence();
  for (int i = 0; i < 16; ++i) {
    hypothesis.T_camera_object.matrix()(i / 4, i % 4) = message.t_camera_object(i);
  }
  for (int i = 0; i < 36; ++i) hypothesis.covariance(i / 6, i % 6) = message.covariance(i);
  hypothesis.model_points = message.model_points();
  hypothesis.visible_points = message.visible_points();
  hypothesis.rms_px = message.rms_px();
  hypothesis.log10_nfa = message.log10_nfa();
  hypothesis.edge_share = message.edge_share();
  hypothesis.margin = message.margin();
  hypothesis.symmetry = message.symmetry();
  hypothesis.ambiguous = message.ambiguous();
  for (const v1::MonoPair& pair : message.pairs()) {
    hypothesis.pairs.push_back({pair.model(), pair.image(), pair.residual_px()});
  }
  return hypothesis;
}

}  // namespace

v1::Camera to_proto(const Camera& camera) {
  v1::Camera message;
  message.set_width(camera.width);
  message.set_height(camera.height);
  message.set_fx(camera.fx);
  message.set_fy(camera.fy);
  message.set_cx(camera.cx);
  message.set_cy(camera.cy);
  for (const double k : camera.dist) message.add_dist(k);
  return message;
}

v1::ImagePoints to_proto(const std::vector<ImagePoint>& points,
                         const std::vector<std::array<std::uint32_t, 2>>& links) {
  v1::ImagePoints message;
  for (const ImagePoint& point : points) {
    v1::ImagePoint& added = *message.add_points();
    added.set_type(to_proto(point.type));
    added.set_u(point.uv.x());
    added.set_v(point.uv.y());
    for (const double direction : point.directions_rad) added.add_directions_rad(direction);
  }
  for (const auto& [a, b] : links) {
    message.add_links(a);
    message.add_links(b);
  }
  return message;
}

v1::RecognizeRequest to_proto(const RecognizeInput& input, const RecognizeOptions& options) {
  v1::RecognizeRequest message;
  *message.mutable_camera() = to_proto(input.camera);
  if (!input.image.empty()) {
    message.set_image(input.image);
  } else {
    *message.mutable_points() = to_proto(input.points, input.links);
  }
  v1::RecognizeOptions& wire = *message.mutable_options();
  for (const std::string& model : options.models) wire.add_models(model);
  wire.set_top(static_cast<std::uint32_t>(options.top));
  wire.set_min_confidence(options.min_confidence);
  wire.set_min_depth_m(options.min_depth_m);
  wire.set_max_depth_m(options.max_depth_m);
  wire.set_seed(options.seed);
  wire.set_want_overlay(input.want_overlay);
  return message;
}

v1::ModelAddRequest to_proto(const ModelAdd& add) {
  v1::ModelAddRequest message;
  message.set_name(add.name);
  message.set_file(add.file);
  message.set_file_name(add.file_name);
  message.set_units(add.units);
  return message;
}

RecognizeAnswer from_proto(const v1::RecognizeResult& message) {
  RecognizeAnswer answer;
  RecognizeResult& result = answer.result;
  switch (message.status()) {
    case v1::RECOGNIZE_STATUS_RECOGNIZED:
      result.status = RecognizeStatus::kRecognized;
      break;
    case v1::RECOGNIZE_STATUS_NOT_FOUND:
      result.status = RecognizeStatus::kNotFound;
      break;
    default:
      refuse("status " + std::to_string(message.status()));
  }
  if (result.status == RecognizeStatus::kRecognized && message.hypotheses().empty()) {
    refuse("recognized, but no hypothesis");
  }
  result.reason = message.reason();
  for (const v1::MonoHypothesis& hypothesis : message.hypotheses()) {
    result.hypotheses.push_back(from_proto(hypothesis));
  }
  result.image_points = message.image_points();
  result.seed = message.seed();
  result.warnings.assign(message.warnings().begin(), message.warnings().end());
  const v1::RecognizeTimings& t = message.timing();
  using Duration = StageTimings::Duration;
  result.timings = {Duration(t.features_ms()),
                    Duration(t.lookup_ms()),
                    Duration(t.verify_ms()),
                    Duration(t.refine_ms()),
                    Duration(t.total_ms())};
  answer.overlay_png = message.overlay_png();
  return answer;
}

ModelSummary from_proto(const v1::ModelInfo& message) {
  ModelSummary model;
  model.id = message.model_id();
  model.name = message.name();
  model.created = message.created();
  model.source = message.source();
  model.unit_scale = message.unit_scale();
  model.points_of_type = {
      message.vertices(), message.conic_centres(), message.centroids(), message.inflexions()};
  for (const std::size_t count : model.points_of_type) model.points += count;
  model.edges = message.edges();
  model.faces = message.faces();
  model.circles = message.circles();
  model.triples = message.triples();
  model.symmetry = message.symmetry();
  model.symmetries = message.symmetries();
  model.diameter_m = message.diameter_m();
  model.warnings.assign(message.warnings().begin(), message.warnings().end());
  model.sha256 = message.sha256();
  if (!message.quarantined().empty()) model.damage = message.quarantined();
  return model;
}

}  // namespace landmarkdb::client
