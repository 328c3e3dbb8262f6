#include "client/render_explanation.hpp"

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <utility>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegrees = 180.0 / std::numbers::pi;
// Log-odds that are worth a word: a confidence of 0.5 becomes 0.56.
constexpr double kWorthAWord = 0.25;

Json steps_json(const std::vector<FunnelStep>& steps) {
  Json out = Json::array();
  for (const FunnelStep& step : steps) out.push_back({{"step", step.name}, {"left", step.count}});
  return out;
}

Json candidate_json(const ExplainedCandidate& c) {
  Json out;
  out["scene"] = c.scene;
  out["role"] = role_name(c.role);
  out["T_scene_sensor"] = to_row_major(c.T_scene_sensor);
  out["confidence"] = c.confidence;
  out["quality"] = c.quality;
  out["overlap"] = c.overlap;
  out["explained"] = c.explained;
  out["free_space_violation"] = c.crossed;
  out["coverage"] = c.coverage;
  out["observability"] = c.observability;
  out["margin"] = c.margin;
  out["deviation"] = std::vector<double>(c.deviation.data(), c.deviation.data() + 6);
  out["distance_m"] = c.distance_m ? Json(*c.distance_m) : Json(nullptr);
  out["turn_rad"] = c.turn_rad ? Json(*c.turn_rad) : Json(nullptr);
  out["terms"] = Json::array();
  for (const ConfidenceTerm& term : c.terms) {
    out["terms"].push_back({{"name", term.name},
                            {"value", term.value},
                            {"ideal", term.ideal},
                            {"worth", term.worth},
                            {"cost", term.cost}});
  }
  return out;
}

std::string axes_text(const ExplainedCandidate& c) {
  const Eigen::Vector3d turn = c.deviation.tail<3>() * kDegrees;
  return print("x %.3f  y %.3f  z %.3f m, about x %.2f  y %.2f  z %.2f deg",
               c.deviation(0),
               c.deviation(1),
               c.deviation(2),
               turn.x(),
               turn.y(),
               turn.z());
}

std::string candidate_text(std::size_t number, const ExplainedCandidate& c) {
  std::string out =
      print("  %zu. ", number) + std::string(role_name(c.role)) + " in " + cli::printable(c.scene) +
      print(", confidence %.2f, quality %.2f, overlap %.2f", c.confidence, c.quality, c.overlap);
  if (c.distance_m && c.turn_rad) {
    out += print(", %.2f m and %.0f deg from the best", *c.distance_m, *c.turn_rad * kDegrees);
  }
  const ForAndAgainst words = weigh(c);
  out += "\n     for      " + cli::printable(words.spoke_for) + "\n     against  " +
         cli::printable(words.spoke_against) + "\n";
  return out + "     sure to  " + axes_text(c) + "\n";
}

std::string funnel_text(const std::vector<FunnelStep>& funnel) {
  cli::Table table({{"  left", cli::Align::kRight}, {"of", cli::Align::kLeft}});
  for (const FunnelStep& step : funnel) {
    table.add({cli::count_text(step.count), step_meaning(step.name)});
  }
  return table.text();
}

std::string scenes_text(const std::vector<SceneFunnel>& scenes) {
  if (scenes.size() < 2) return {};
  std::vector<cli::Table::Column> columns = {{"  scene", cli::Align::kLeft}};
  for (const FunnelStep& step : scenes[0].steps) columns.push_back({step.name, cli::Align::kRight});
  columns.push_back({"quality", cli::Align::kRight});
  cli::Table table(columns);
  for (const SceneFunnel& scene : scenes) {
    std::vector<std::string> cells = {"  " + scene.scene};
    for (const FunnelStep& step : scene.steps) cells.push_back(cli::count_text(step.count));
    cells.push_back(scene.best_quality > 0.0 ? print("%.2f", scene.best_quality) : "-");
    cells.resize(columns.size());
    table.add(cells);
  }
  return table.text();
}

}  // namespace

std::string step_meaning(const std::string& name) {
  static constexpr std::pair<std::string_view, std::string_view> kMeanings[] = {
      {"points", "points of the cloud"},
      {"used", "points that are finite, single and within reach"},
      {"keypoints", "keypoints described"},
      {"putative", "pairs of like descriptors"},
      {"ratio", "pairs after the ratio filter"},
      {"slope", "pairs after the slope filter"},
      {"clique", "pairs after the clique filter"},
      {"proposals", "poses proposed and tested on the surface"},
      {"survivors", "poses that did well there and differ"},
      {"refined", "poses refined, the best of each scene"},
      {"verified", "poses verified with all points and held against free space"},
      {"expected", "poses that agree with what was said by --up or --prior"},
      {"places", "different places among them"},
      {"confident", "places that reach --min-confidence"},
  };
  for (const auto& [known, meaning] : kMeanings) {
    if (known == name) return std::string(meaning);
  }
  return name;
}

std::string_view role_name(CandidateRole role) {
  switch (role) {
    case CandidateRole::kBest:
      return "best";
    case CandidateRole::kRival:
      return "rival";
    case CandidateRole::kBehind:
      return "behind";
  }
  return "behind";
}

std::string remedy_sentence(const Remedy& remedy) {
  const std::string result = remedy.effect == "localized"   ? "would have made it localized"
                             : remedy.effect == "ambiguous" ? "would have made it ambiguous"
                                                            : remedy.effect;
  if (remedy.option == "--min-confidence") {
    return "--min-confidence " + remedy.value +
           (remedy.effect == "localized" ? " would have accepted it" : " " + result) +
           "; answers that weak are wrong more often";
  }
  if (remedy.option == "--up") {
    return "an --up vector would have removed the rival, were the best pose right: " +
           remedy.effect;
  }
  if (remedy.option == "--scene") {
    return "--scene '" + remedy.value + "', where that is known, " + result;
  }
  if (remedy.option == "--prior-radius") {
    return "a --prior within " + remedy.value + " m of the best pose, where that is known, " +
           result;
  }
  return remedy.option + (remedy.value.empty() ? " " : " " + remedy.value + ": ") + result;
}

ForAndAgainst weigh(const ExplainedCandidate& candidate) {
  ForAndAgainst words;
  const auto add = [](std::string& list, const std::string& item) {
    list += (list.empty() ? "" : ", ") + item;
  };
  std::vector<ConfidenceTerm> by_worth = candidate.terms;
  std::stable_sort(by_worth.begin(), by_worth.end(), [](const auto& a, const auto& b) {
    return a.worth > b.worth;
  });
  for (const ConfidenceTerm& term : by_worth) {
    if (term.worth < kWorthAWord) continue;
    add(words.spoke_for, term.name + print(" %.3f (+%.1f)", term.value, term.worth));
  }
  for (const ConfidenceTerm& term : candidate.terms) {
    if (term.cost < kWorthAWord) continue;
    add(words.spoke_against, term.name + print(" %.3f (-%.1f)", term.value, term.cost));
  }
  if (words.spoke_for.empty()) words.spoke_for = "nothing";
  if (words.spoke_against.empty()) words.spoke_against = "nothing";
  return words;
}

Json explanation_json(const Explanation& explanation) {
  Json out;
  out["funnel"] = steps_json(explanation.funnel);
  out["scenes"] = Json::array();
  for (const SceneFunnel& scene : explanation.scenes) {
    out["scenes"].push_back({{"scene", scene.scene},
                             {"funnel", steps_json(scene.steps)},
                             {"best_quality", scene.best_quality}});
  }
  out["candidates"] = Json::array();
  for (const ExplainedCandidate& candidate : explanation.candidates) {
    out["candidates"].push_back(candidate_json(candidate));
  }
  out["lost_at"] = explanation.lost_at.empty() ? Json(nullptr) : Json(explanation.lost_at);
  out["why"] = explanation.why;
  out["would_have_changed_it"] = Json::array();
  for (const Remedy& remedy : explanation.remedies) {
    out["would_have_changed_it"].push_back(
        {{"option", remedy.option}, {"value", remedy.value}, {"effect", remedy.effect}});
  }
  return out;
}

std::string explanation_text(const Explanation& explanation) {
  std::string out = "\nwhat each step left\n" + funnel_text(explanation.funnel);
  if (const std::string scenes = scenes_text(explanation.scenes); !scenes.empty()) {
    out += "\nscene by scene\n" + scenes;
  }
  if (!explanation.candidates.empty()) out += "\nwhat was weighed\n";
  for (std::size_t i = 0; i < explanation.candidates.size(); ++i) {
    out += candidate_text(i + 1, explanation.candidates[i]);
  }
  if (!explanation.lost_at.empty()) {
    out += "\nlost at " + cli::printable(explanation.lost_at) + ": " +
           cli::printable(explanation.why) + "\n";
    if (explanation.remedies.empty())
      out += "  no option alone would have changed that, with the poses that were found\n";
  }
  for (const Remedy& remedy : explanation.remedies) {
    out += "  " + cli::printable(remedy_sentence(remedy)) + "\n";
  }
  return out;
}

}  // namespace landmarkdb::client
