#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cli/table.hpp"
#include "client/render_explanation.hpp"
#include "client/report/html.hpp"
#include "client/report/markup.hpp"
#include "client/report/sections.hpp"
#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string candidates_html(const Explanation& explanation) {
  if (explanation.candidates.empty()) return {};
  HtmlTable table({"",
                   "Scene",
                   "#Confidence",
                   "#Quality",
                   "#Overlap",
                   "#Explained",
                   "#Crossed",
                   "#Coverage",
                   "#Margin",
                   "From the best",
                   "Spoke for it",
                   "Spoke against it"});
  for (const ExplainedCandidate& c : explanation.candidates) {
    const ForAndAgainst words = weigh(c);
    std::string away = c.role == CandidateRole::kBest ? "" : "another scene";
    if (c.distance_m && c.turn_rad) {
      away = print("%.2f m, %.0f deg", *c.distance_m, *c.turn_rad * kDegrees);
    }
    table.add({std::string(role_name(c.role)),
               html_name(c.scene),
               print("%.2f", c.confidence),
               print("%.2f", c.quality),
               print("%.2f", c.overlap),
               print("%.2f", c.explained),
               print("%.2f", c.crossed),
               print("%.2f", c.coverage),
               print("%.2f", c.margin),
               away,
               "<span class=\"for\">" + html_text(words.spoke_for) + "</span>",
               "<span class=\"against\">" + html_text(words.spoke_against) + "</span>"});
  }
  return "<h2>What was weighed</h2>\n" +
         table.html("In brackets: what the figure gave to the confidence or cost it, in log-odds.");
}

std::string axes_html(const Explanation& explanation) {
  if (explanation.candidates.empty()) return {};
  HtmlTable table(
      {"", "Scene", "#x", "#y", "#z", "#about x", "#about y", "#about z", "#Observability"});
  for (const ExplainedCandidate& c : explanation.candidates) {
    std::vector<std::string> cells = {std::string(role_name(c.role)), html_name(c.scene)};
    for (int i = 0; i < 3; ++i) cells.push_back(print("%.1f mm", 1000.0 * c.deviation(i)));
    for (int i = 3; i < 6; ++i) cells.push_back(print("%.2f deg", kDegrees * c.deviation(i)));
    cells.push_back(print("%.3f", c.observability));
    table.add(cells);
  }
  return "<h3>How sure each axis is</h3>\n" +
         table.html("One standard deviation along and about the scene's axes.");
}

std::string funnel_html(const Explanation& explanation) {
  HtmlTable table({"#Left", "of", "<span class=\"barcell\">on a logarithmic scale</span>"});
  double most = 1.0;
  for (const FunnelStep& step : explanation.funnel) {
    most = std::max(most, std::log1p(static_cast<double>(step.count)));
  }
  for (const FunnelStep& step : explanation.funnel) {
    const double share = std::log1p(static_cast<double>(step.count)) / most;
    table.add({cli::count_text(step.count),
               html_text(step_meaning(step.name)),
               "<div class=\"barcell\">" + bar(share) + "</div>"});
  }
  return "<h2>What each step left</h2>\n" + table.html();
}

std::string scenes_html(const Explanation& explanation) {
  if (explanation.scenes.size() < 2) return {};
  std::vector<std::string> titles = {"Scene"};
  for (const FunnelStep& step : explanation.scenes[0].steps) {
    titles.push_back("#" + html_text(step.name));
  }
  titles.emplace_back("#best quality");
  HtmlTable table(titles);
  for (const SceneFunnel& scene : explanation.scenes) {
    std::vector<std::string> cells = {html_name(scene.scene)};
    for (const FunnelStep& step : scene.steps) cells.push_back(cli::count_text(step.count));
    cells.push_back(scene.best_quality > 0.0 ? print("%.2f", scene.best_quality) : "-");
    table.add(cells);
  }
  return "<h3>Scene by scene</h3>\n" + table.html();
}

std::string remedies_html(const Explanation& explanation) {
  if (explanation.lost_at.empty()) return {};
  std::string out = "<h2>What would have changed it</h2>\n";
  if (explanation.remedies.empty()) {
    return out + "<p>No option alone, with the poses that were found.</p>\n";
  }
  out += "<ul>";
  for (const Remedy& remedy : explanation.remedies) {
    out += "<li>" + html_text(remedy_sentence(remedy)) + "</li>";
  }
  return out + "</ul>\n";
}

std::string matrix_html(const char* name, const Eigen::Matrix4d& T) {
  std::string out =
      "<div class=\"matrix\"><table><caption>" + std::string(name) + "</caption><tbody>";
  for (int row = 0; row < 4; ++row) {
    out += "<tr>";
    for (int column = 0; column < 4; ++column) {
      const double value = T(row, column) == 0.0 ? 0.0 : T(row, column);  // no minus zero
      out += "<td>" + print(row == 3 ? "%.0f" : "%.4f", value) + "</td>";
    }
    out += "</tr>";
  }
  return out + "</tbody></table></div>\n";
}

std::string chain_html(const Hypothesis& h) {
  const auto sign = [](const char* text) {
    return "<span class=\"sign\">" + std::string(text) + "</span>\n";
  };
  return "<div class=\"scroll\"><div class=\"chain\">\n" +
         matrix_html("T_scene_sensor", h.T_scene_sensor) + sign("=") +
         matrix_html("T_icp", h.chain.T_icp) + sign("\u00b7") +
         matrix_html("T_scene_landmark", h.chain.T_scene_landmark) + sign("\u00b7") +
         matrix_html("T_landmark_sensor", h.chain.T_landmark_sensor) + "</div></div>\n";
}

}  // namespace

std::string explanation_html(const QueryResult& result) {
  if (!result.explanation) return {};
  const Explanation& explanation = *result.explanation;
  return remedies_html(explanation) + candidates_html(explanation) + axes_html(explanation) +
         funnel_html(explanation) + scenes_html(explanation);
}

std::string poses_html(const QueryResult& result) {
  if (result.hypotheses.empty()) return {};
  std::string out =
      "<h2>The pose, as a chain of three</h2>\n<p class=\"soft\">Right to left: the sensor into "
      "the "
      "frame of the surface that was recognised, that surface into the scene, and what refinement "
      "added. Metres.</p>\n";
  for (std::size_t i = 0; i < result.hypotheses.size(); ++i) {
    const Hypothesis& h = result.hypotheses[i];
    const std::string title = std::to_string(i + 1) + ". " + html_name(h.scene) +
                              print(" version %lld, confidence %.2f, scale %.4f",
                                    static_cast<long long>(h.scene_version),
                                    h.confidence,
                                    h.chain.scale);
    out += std::string("<details") + (i == 0 ? " open" : "") + "><summary>" + title +
           "</summary>\n" + chain_html(h);
    out += print(
        "<p class=\"soft\">Pairs: %u putative, %u after ratio, %u after slope, %u consistent, %u "
        "inliers. Fit: rmse %.1f mm, free space violated %.2f, observability %.3f.</p></details>\n",
        h.counts.putative,
        h.counts.after_ratio,
        h.counts.after_slope,
        h.counts.after_consistency,
        h.counts.inliers,
        1000.0 * h.fit.rmse_m,
        h.fit.free_space_violation,
        h.fit.observability);
  }
  return out;
}

std::string counts_html(const ReportInput& input, const QueryResult& result) {
  const StageTimings& t = result.timings;
  const std::pair<const char*, double> stages[] = {{"load", t.load.count()},
                                                   {"preprocess", t.preprocess.count()},
                                                   {"keypoints", t.keypoints.count()},
                                                   {"describe", t.describe.count()},
                                                   {"match", t.match.count()},
                                                   {"filter", t.filter.count()},
                                                   {"pose", t.pose.count()},
                                                   {"icp", t.icp.count()},
                                                   {"verify", t.verify.count()},
                                                   {"total", t.total.count()}};
  HtmlTable table({"Stage", "#ms", "<span class=\"barcell\">share</span>"});
  for (const auto& [name, ms] : stages) {
    table.add({name,
               print("%.0f", ms),
               "<div class=\"barcell\">" + bar(ms / std::max(1e-9, t.total.count())) + "</div>"});
  }
  std::string out = "<h2>Where the time went</h2>\n" + table.html();
  out += "<h2>What was asked</h2>\n<p>" + html_name(input.cloud_name) + ": " +
         cli::count_text(result.query.points) + " points, " +
         cli::count_text(result.query.points_used) + " used, " +
         cli::count_text(result.query.keypoints) + " keypoints; profile " +
         (input.options.profile == Profile::kPaper ? "paper" : "robust") +
         print(", confidence wanted %.2f", input.options.min_confidence);
  out += input.options.up ? ", up given" : ", up not given";
  if (input.options.prior_T_scene_sensor) {
    out += print(", prior of %.2f m", input.options.prior_radius_m);
  }
  for (std::size_t i = 0; i < input.options.scenes.size(); ++i) {
    out += (i == 0 ? ", in " : " or ") + html_name(input.options.scenes[i]);
  }
  return out + ", seed " + std::to_string(result.seed) + ".</p>\n";
}

}  // namespace landmarkdb::client
