#include "client/render_json.hpp"

#include <numbers>

#include <nlohmann/json.hpp>

#include "client/pose_values.hpp"
#include "client/render_explanation.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

template <typename Numbers>
Json numbers_json(const Numbers& numbers) {
  Json out = Json::array();
  for (const double number : numbers) out.push_back(number);
  return out;
}

Json covariance_json(const Eigen::Matrix<double, 6, 6>& covariance) {
  Json out = Json::array();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) out.push_back(covariance(row, column));
  }
  return out;
}

Json hypothesis_json(const Hypothesis& h) {
  // With an estimated scale T_scene_sensor is a similarity; its rotation is what is left without.
  const Eigen::Matrix3d R = nearest_rotation(h.T_scene_sensor.topLeftCorner<3, 3>());
  Json out;
  out["scene"] = h.scene;
  out["landmark"] = h.landmark ? Json(*h.landmark) : Json(nullptr);
  out["confidence"] = h.confidence;
  out["T_scene_sensor"] = numbers_json(to_row_major(h.T_scene_sensor));
  out["translation_m"] = vector_json(h.T_scene_sensor.topRightCorner<3, 1>());
  out["rotation_xyzw"] = rotation_json(R);
  out["roll_pitch_yaw_deg"] = vector_json(roll_pitch_yaw_rad(R) * (180.0 / std::numbers::pi));
  out["chain"] = {{"T_landmark_sensor", numbers_json(to_row_major(h.chain.T_landmark_sensor))},
                  {"T_scene_landmark", numbers_json(to_row_major(h.chain.T_scene_landmark))},
                  {"T_icp", numbers_json(to_row_major(h.chain.T_icp))},
                  {"scale", h.chain.scale}};
  out["correspondences"] = {{"putative", h.counts.putative},
                            {"after_ratio", h.counts.after_ratio},
                            {"after_slope", h.counts.after_slope},
                            {"after_consistency", h.counts.after_consistency},
                            {"inliers", h.counts.inliers}};
  out["fit"] = {{"overlap", h.fit.overlap},
                {"rmse_m", h.fit.rmse_m},
                {"free_space_violation", h.fit.free_space_violation},
                {"margin", h.fit.margin},
                {"observability", h.fit.observability},
                {"explained", h.fit.explained},
                {"coverage", h.fit.coverage},
                {"quality", h.fit.quality},
                {"contrast", h.fit.contrast},
                {"contradicted", h.fit.contradicted},
                {"refuted", h.fit.refuted},
                {"agreeing", h.fit.agreeing}};
  out["covariance"] = covariance_json(h.covariance);
  out["rival"] = h.rival;
  out["scene_version"] = h.scene_version;
  return out;
}

Json timings_json(const StageTimings& t) {
  return {{"load", t.load.count()},
          {"preprocess", t.preprocess.count()},
          {"keypoints", t.keypoints.count()},
          {"describe", t.describe.count()},
          {"match", t.match.count()},
          {"filter", t.filter.count()},
          {"pose", t.pose.count()},
          {"icp", t.icp.count()},
          {"verify", t.verify.count()},
          {"total", t.total.count()}};
}

}  // namespace

nlohmann::ordered_json query_json(const QueryResult& result) {
  Json out;
  out["status"] = status_name(result.status);
  if (result.status == QueryStatus::kNotFound) out["reason"] = result.reason;
  out["hypotheses"] = Json::array();
  for (const Hypothesis& hypothesis : result.hypotheses) {
    out["hypotheses"].push_back(hypothesis_json(hypothesis));
  }
  out["query"] = {{"points", result.query.points},
                  {"points_used", result.query.points_used},
                  {"invalid", result.query.invalid},
                  {"keypoints", result.query.keypoints},
                  {"density_ratio", result.query.density_ratio},
                  {"seed", result.seed}};
  out["warnings"] = result.warnings;
  out["timing_ms"] = timings_json(result.timings);
  if (result.explanation) out["explain"] = explanation_json(*result.explanation);
  return out;
}

std::string dump(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string_view status_name(QueryStatus status) {
  switch (status) {
    case QueryStatus::kLocalized:
      return "localized";
    case QueryStatus::kAmbiguous:
      return "ambiguous";
    case QueryStatus::kNotFound:
      return "not_found";
  }
  return "not_found";
}

int query_exit_status(QueryStatus status) {
  switch (status) {
    case QueryStatus::kLocalized:
      return 0;
    case QueryStatus::kAmbiguous:
      return 4;
    case QueryStatus::kNotFound:
      return 3;
  }
  return 3;
}

}  // namespace landmarkdb::client
