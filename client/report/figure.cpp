#include <algorithm>

#include "cli/table.hpp"
#include "client/report/html.hpp"
#include "client/report/markup.hpp"
#include "client/report/picture.hpp"
#include "client/report/sections.hpp"
#include "engine/base/print.hpp"

namespace landmarkdb::client {
namespace {

std::string toggle(const char* what, const char* key, const std::string& label) {
  return std::string("<label><input type=\"checkbox\" data-show=\"") + what + "\"> " +
         (*key != '\0' ? "<span class=\"key " + std::string(key) + "\"></span>" : "") + label +
         "</label>\n";
}

std::string tabs(const Drawing& drawing, const QueryResult& result) {
  if (drawing.candidates.size() < 2) return {};
  std::string out = "<div class=\"controls\" role=\"group\" aria-label=\"Which pose is drawn\">";
  for (std::size_t i = 0; i < drawing.candidates.size(); ++i) {
    const Hypothesis& h = result.hypotheses[i];
    out += "<button type=\"button\" data-candidate=\"" + std::to_string(i) + "\" aria-pressed=\"" +
           (i == 0 ? "true" : "false") + "\">" + std::to_string(i + 1) + ". " + html_name(h.scene) +
           print(" (%.2f)</button>\n", h.confidence);
  }
  return out + "</div>\n";
}

std::string pair_label(const QueryResult& result, bool inliers, std::size_t drawn) {
  const auto all = static_cast<std::uint64_t>(std::count_if(
      result.correspondences.begin(), result.correspondences.end(), [&](const auto& pair) {
        return pair.dropped_by.empty() == inliers;
      }));
  const std::string name = inliers ? "inlier pairs" : "rejected pairs";
  if (drawn == all) return cli::count_text(all) + " " + name;
  return cli::count_text(drawn) + " of " + cli::count_text(all) + " " + name;
}

std::string stage(const char* id, const char* name, const Drawing& drawing, Aspect aspect) {
  return "<figure><div class=\"stage\">" + static_picture(drawing, aspect) + "<canvas id=\"" + id +
         "\" tabindex=\"0\" role=\"img\" aria-label=\"" + name +
         "\" aria-describedby=\"verdict\"></canvas></div><figcaption>" + name +
         "</figcaption></figure>\n";
}

std::string caption(const Drawing& drawing) {
  if (drawing.candidates.empty()) {
    return "No pose to lay the cloud into a place by: it is drawn alone, in its own frame.";
  }
  const DrawnCandidate& best = drawing.candidates[0];
  std::string text = "Drawn are " + cli::count_text(best.place->points.size()) + " points, one a " +
                     print("%.0f cm", 100.0 * best.place->spacing_m) + " voxel, of the scene's " +
                     cli::count_text(best.place->scene_points) +
                     (best.place->whole ? "" : " (what lies about the pose)") + ", and " +
                     cli::count_text(drawing.query.size()) + " of the cloud.";
  if (best.cut_m) {
    text += " The view from above is cut 0.3 m over the sensor, as a ceiling would hide the rest.";
  }
  return text;
}

}  // namespace

std::string figure_html(const Drawing& drawing, const QueryResult& result) {
  std::string out =
      "<section id=\"figure\" aria-labelledby=\"figure-title\">\n<h2 id=\"figure-title\">";
  out += drawing.candidates.empty() ? "The cloud" : "The cloud in the place";
  out += "</h2>\n" + tabs(drawing, result) + "<div class=\"views\">\n";
  out += stage("above", "From above", drawing, Aspect::kAbove);
  out += stage("side", "From the side", drawing, Aspect::kSide);
  out += "</div>\n<div class=\"controls\">\n";
  if (!drawing.candidates.empty()) {
    const DrawnCandidate& best = drawing.candidates[0];
    out += toggle("place", "place", "place");
    out += toggle("query", "query", "cloud");
    if (!result.correspondences.empty()) {
      out += toggle("inliers", "inlier", pair_label(result, true, best.inliers.size()));
      out += toggle("rejected", "rejected", pair_label(result, false, best.rejected.size()));
    }
    if (best.cut_m) out += toggle("cut", "", "cut from above");
  }
  out += toggle("frustum", "frustum", "field of view");
  out += toggle("frames", "landmark", "frames of sensor, landmark and scene");
  out += "<button type=\"button\" data-reset>As at first</button>\n";
  out +=
      "<span class=\"soft\">drag to turn, shift-drag to move, wheel to zoom, double-click for the "
      "first view; arrows and + - on the keyboard</span>\n</div>\n";
  return out + "<p class=\"soft\">" + caption(drawing) + "</p>\n</section>\n";
}

}  // namespace landmarkdb::client
