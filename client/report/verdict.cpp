#include <numbers>

#include "client/render_json.hpp"
#include "client/render_text.hpp"
#include "client/report/html.hpp"
#include "client/report/markup.hpp"
#include "client/report/sections.hpp"
#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

std::string headline(const QueryResult& result) {
  switch (result.status) {
    case QueryStatus::kLocalized:
      return "\u2713 Localized in " + html_name(result.hypotheses.at(0).scene);
    case QueryStatus::kAmbiguous:
      return "\u2248 Ambiguous: " + ambiguity_text(result.hypotheses);
    case QueryStatus::kNotFound:
      return "\u2717 Not found";
  }
  return {};
}

std::string pose_sentence(const Hypothesis& h) {
  const Eigen::Vector3d t = h.T_scene_sensor.topRightCorner<3, 1>();
  const Eigen::Vector3d rpy =
      roll_pitch_yaw_rad(nearest_rotation(h.T_scene_sensor.topLeftCorner<3, 3>())) *
      (180.0 / std::numbers::pi);
  std::string text = "the sensor at x " + print("%.3f", t.x()) + ", y " + print("%.3f", t.y()) +
                     ", z " + print("%.3f", t.z()) + " m, roll " + print("%.1f", rpy.x()) +
                     ", pitch " + print("%.1f", rpy.y()) + ", yaw " + print("%.1f", rpy.z()) +
                     " deg in scene " + html_name(h.scene);
  if (h.landmark) text += ", landmark " + html_name(*h.landmark);
  return text + print("; confidence %.2f, overlap %.2f, margin %.2f",
                      h.confidence,
                      h.fit.overlap,
                      h.fit.margin);
}

std::string warnings_html(const QueryResult& result) {
  if (result.warnings.empty()) return {};
  std::string out = "<ul class=\"warnings\">";
  for (const std::string& warning : result.warnings) {
    const std::string_view meaning = warning_meaning(warning);
    out += "<li>Warning: <code>" + html_text(warning) + "</code>";
    if (!meaning.empty()) out += ": " + html_text(meaning);
    out += "</li>";
  }
  return out + "</ul>";
}

}  // namespace

std::string verdict_html(const ReportInput& input, const QueryResult& result) {
  std::string out = "<div class=\"verdict " + std::string(status_name(result.status)) +
                    "\" id=\"verdict\">\n<h1>" + headline(result) + "</h1>\n";
  out += "<p>Where was " + html_name(input.cloud_name) + " taken? ";
  if (result.status == QueryStatus::kLocalized) {
    out += "It was seen with " + pose_sentence(result.hypotheses.at(0)) + ".";
  } else if (!result.hypotheses.empty()) {
    out += "The best pose has " + pose_sentence(result.hypotheses[0]) + ".";
  }
  out += "</p>\n";
  if (!result.reason.empty()) out += "<p>Reason: " + html_text(result.reason) + "</p>\n";
  if (result.explanation && !result.explanation->why.empty() &&
      result.explanation->why != result.reason) {
    out += "<p>Lost at " + html_text(result.explanation->lost_at) + ": " +
           html_text(result.explanation->why) + ".</p>\n";
  }
  return out + warnings_html(result) + "</div>";
}

}  // namespace landmarkdb::client
