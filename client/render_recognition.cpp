#include "client/render_recognition.hpp"

#include <nlohmann/json.hpp>

#include "cli/model_view.hpp"
#include "cli/table.hpp"
#include "client/pose_values.hpp"
#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

Json hypothesis_json(const MonoHypothesis& h, std::size_t image_points) {
  const Eigen::Matrix3d R = h.T_camera_object.linear();
  Json out;
  out["model"] = h.model;
  out["confidence"] = h.confidence;
  out["T_camera_object"] = to_row_major(h.T_camera_object.matrix());
  out["euler_zyx_deg"] = vector_json(euler_zyx_deg(R));
  out["translation_m"] = vector_json(h.T_camera_object.translation());
  out["matched"] = h.pairs.size();
  out["model_points"] = h.model_points;
  out["image_points"] = image_points;
  out["rms_px"] = h.rms_px;
  out["symmetry"] = h.symmetry;
  out["pairs"] = Json::array();
  for (const MonoPair& pair : h.pairs) {
    out["pairs"].push_back(
        {{"model", pair.model}, {"image", pair.image}, {"residual_px", pair.residual_px}});
  }
  out["rotation_xyzw"] = rotation_json(R);
  Json covariance = Json::array();
  for (int i = 0; i < 36; ++i) covariance.push_back(h.covariance(i / 6, i % 6));
  out["covariance"] = std::move(covariance);
  out["visible_points"] = h.visible_points;
  out["ambiguous"] = h.ambiguous;
  out["log10_nfa"] = h.log10_nfa;
  out["edge_share"] = h.edge_share;
  out["margin"] = h.margin;
  return out;
}

std::string hypothesis_text(const MonoHypothesis& h) {
  const Eigen::Vector3d t = h.T_camera_object.translation();
  const Eigen::Vector3d angles = euler_zyx_deg(h.T_camera_object.linear());
  std::string text =
      "  pose        " + print("x %.4f  y %.4f  z %.4f m   about z %.2f  y %.2f  x %.2f deg\n",
                               t.x(),
                               t.y(),
                               t.z(),
                               angles.x(),
                               angles.y(),
                               angles.z());
  text += "  matched     " + print("%zu of %zu visible points (%zu in all), rms %.2f px\n",
                                   h.pairs.size(),
                                   h.visible_points,
                                   h.model_points,
                                   h.rms_px);
  text += "  evidence    " + print("log10 false alarms %.1f, edges %.2f, margin %.2f\n",
                                   h.log10_nfa,
                                   h.edge_share,
                                   h.margin);
  if (h.symmetry != "none") {
    text += "  symmetry    " + cli::printable(h.symmetry) +
            ": poses that differ by it are this same answer\n";
  }
  if (h.ambiguous) {
    text += "  ambiguous   a second pose explains the points about as well\n";
  }
  return text;
}

}  // namespace

Json recognition_json(const RecognizeResult& result) {
  Json out;
  const bool found = result.status == RecognizeStatus::kRecognized;
  out["status"] = found ? "recognized" : "not_found";
  if (!found) out["reason"] = result.reason;
  out["hypotheses"] = Json::array();
  for (const MonoHypothesis& hypothesis : result.hypotheses) {
    out["hypotheses"].push_back(hypothesis_json(hypothesis, result.image_points));
  }
  out["image_points"] = result.image_points;
  out["seed"] = result.seed;
  out["warnings"] = result.warnings;
  const RecognizeTimings& t = result.timings;
  out["timing_ms"] = {{"features", t.features.count()},
                      {"lookup", t.lookup.count()},
                      {"verify", t.verify.count()},
                      {"refine", t.refine.count()},
                      {"total", t.total.count()}};
  return out;
}

std::string recognition_text(const RecognizeResult& result) {
  std::string text;
  if (result.status == RecognizeStatus::kNotFound) {
    text = "not found: " + cli::printable(result.reason) + "\n";
  }
  for (std::size_t i = 0; i < result.hypotheses.size(); ++i) {
    const MonoHypothesis& h = result.hypotheses[i];
    const bool first = i == 0 && result.status == RecognizeStatus::kRecognized;
    text += (first ? "recognized: model " : "also: model ") + cli::printable(h.model) +
            print(", confidence %.2f\n", h.confidence) + hypothesis_text(h);
  }
  text += print("  image       %zu feature points, %.1f ms\n",
                result.image_points,
                result.timings.total.count());
  for (const std::string& warning : result.warnings) {
    text += "  warning     " + cli::printable(warning) + "\n";
  }
  return text;
}

int recognize_exit_status(const RecognizeResult& result) {
  if (result.status == RecognizeStatus::kNotFound || result.hypotheses.empty()) return 3;
  // Of log10 false alarms: a rival that is less than twice as likely to come about by chance.
  constexpr double kToldApart = 0.3;
  const MonoHypothesis& best = result.hypotheses.front();
  const bool rival = result.hypotheses.size() > 1 && best.margin < kToldApart;
  return best.ambiguous || rival ? 4 : 0;
}

Json model_json(const ModelInfo& model) {
  Json out = cli::model_json(model.summary);
  if (!model.json.empty()) out["model"] = Json::parse(model.json, nullptr, false);
  return out;
}

Json models_json(const std::vector<ModelSummary>& models) {
  Json array = Json::array();
  for (const ModelSummary& model : models) array.push_back(cli::model_json(model));
  return {{"models", std::move(array)}};
}

}  // namespace landmarkdb::client
