#include "engine/retrieval/explain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/base/print.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/retrieval/hypothesis.hpp"

namespace landmarkdb {

namespace {

bool filter_used(const QueryOptions& options, Filter filter) {
  if (options.profile != Profile::kPaper) return false;
  if (options.filters.empty()) return filter != Filter::kClique;
  return std::find(options.filters.begin(), options.filters.end(), filter) != options.filters.end();
}

// The steps from the pairs to the verified poses, summed over these matches.
std::vector<FunnelStep> search_steps(const QueryOptions& options,
                                     std::span<const EntryMatches* const> matches) {
  const auto sum = [&](const auto& count_of) {
    std::uint64_t total = 0;
    for (const EntryMatches* one : matches) total += count_of(*one);
    return total;
  };
  std::vector<FunnelStep> steps;
  steps.push_back({"putative", sum([](const EntryMatches& m) { return m.counts.putative; })});
  if (filter_used(options, Filter::kRatio)) {
    steps.push_back({"ratio", sum([](const EntryMatches& m) { return m.counts.after_ratio; })});
  }
  if (filter_used(options, Filter::kSlope)) {
    steps.push_back({"slope", sum([](const EntryMatches& m) { return m.counts.after_slope; })});
  }
  if (filter_used(options, Filter::kClique)) {
    steps.push_back(
        {"clique", sum([](const EntryMatches& m) { return m.counts.after_consistency; })});
  }
  steps.push_back({"proposals", sum([](const EntryMatches& m) { return m.poses.proposals; })});
  steps.push_back({"survivors", sum([](const EntryMatches& m) { return m.poses.survivors; })});
  steps.push_back({"refined", sum([](const EntryMatches& m) { return m.poses.refined; })});
  steps.push_back({"verified", sum([](const EntryMatches& m) { return m.poses.verified; })});
  return steps;
}

std::vector<FunnelStep> funnel_of(const Decision& decision) {
  const QueryCounts& counts = decision.answer.query;
  std::vector<FunnelStep> funnel = {
      {"points", counts.points}, {"used", counts.points_used}, {"keypoints", counts.keypoints}};
  std::vector<const EntryMatches*> all;
  for (const EntryMatches& matches : decision.search.matches) all.push_back(&matches);
  for (FunnelStep& step : search_steps(decision.input.options, all)) {
    funnel.push_back(std::move(step));
  }
  const QueryOptions& options = decision.input.options;
  if (options.up || options.prior_T_scene_sensor) {
    funnel.push_back({"expected", decision.search.poses.size()});
  }
  const std::vector<Judged>& judged = decision.verdict.judged;
  funnel.push_back({"places", judged.size()});
  const auto confident = std::count_if(judged.begin(), judged.end(), [&](const Judged& one) {
    return one.confidence >= decision.options.min_confidence;
  });
  funnel.push_back({"confident", static_cast<std::uint64_t>(confident)});
  return funnel;
}

std::vector<SceneFunnel> scene_funnels(const Decision& decision) {
  std::vector<SceneFunnel> scenes;
  for (const EntryMatches& matches : decision.search.matches) {
    SceneFunnel scene;
    scene.scene = decision.input.entries[matches.entry].record().name;
    const EntryMatches* const one[] = {&matches};
    scene.steps = search_steps(decision.input.options, one);
    for (const Assessed& pose : decision.search.poses) {
      if (pose.entry == matches.entry)
        scene.best_quality = std::max(scene.best_quality, pose.score);
    }
    scenes.push_back(std::move(scene));
  }
  // Later steps first, as they say more.
  std::stable_sort(scenes.begin(), scenes.end(), [](const SceneFunnel& a, const SceneFunnel& b) {
    if (a.best_quality != b.best_quality) return a.best_quality > b.best_quality;
    return std::lexicographical_compare(
        b.steps.rbegin(),
        b.steps.rend(),
        a.steps.rbegin(),
        a.steps.rend(),
        [](const FunnelStep& x, const FunnelStep& y) { return x.count < y.count; });
  });
  if (scenes.size() > kMostExplainedScenes) scenes.resize(kMostExplainedScenes);
  return scenes;
}

ExplainedCandidate candidate_of(const Decision& decision, const Judged& judged) {
  const Hypothesis hypothesis = make_hypothesis(judged, decision.input, decision.search);
  ExplainedCandidate candidate;
  candidate.scene = hypothesis.scene;
  candidate.T_scene_sensor = hypothesis.T_scene_sensor;
  candidate.confidence = hypothesis.confidence;
  candidate.quality = hypothesis.fit.quality;
  candidate.overlap = hypothesis.fit.overlap;
  candidate.explained = hypothesis.fit.explained;
  candidate.crossed = hypothesis.fit.free_space_violation;
  candidate.coverage = hypothesis.fit.coverage;
  candidate.observability = hypothesis.fit.observability;
  candidate.margin = hypothesis.fit.margin;
  candidate.deviation = hypothesis.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  candidate.terms = confidence_terms(judged.pose.evidence, judged.pose.score, judged.margin);
  return candidate;
}

std::vector<ExplainedCandidate> candidates_of(const Decision& decision) {
  const std::vector<Judged>& judged = decision.verdict.judged;
  std::vector<ExplainedCandidate> candidates;
  for (std::size_t i = 0; i < std::min(judged.size(), kMostExplainedCandidates); ++i) {
    candidates.push_back(candidate_of(decision, judged[i]));
    if (i == 0) continue;
    ExplainedCandidate& one = candidates.back();
    const ExplainedCandidate& best = candidates.front();
    one.role = judged[i].rival ? CandidateRole::kRival : CandidateRole::kBehind;
    if (judged[i].pose.entry != judged[0].pose.entry) continue;
    one.distance_m = (one.T_scene_sensor - best.T_scene_sensor).topRightCorner<3, 1>().norm();
    one.turn_rad = rotation_angle_rad(judged[0].pose.T_entry_sensor.linear().transpose() *
                                      judged[i].pose.T_entry_sensor.linear());
  }
  return candidates;
}

// The first rival and how close it is; empty where there is none.
std::string rival_text(std::span<const ExplainedCandidate> candidates) {
  const auto rival =
      std::find_if(candidates.begin(), candidates.end(), [](const ExplainedCandidate& one) {
        return one.role == CandidateRole::kRival;
      });
  if (rival == candidates.end()) return {};
  const ExplainedCandidate& best = candidates.front();
  const std::string lead = print(
      " explains the cloud about as well: quality %.3f against %.3f", rival->quality, best.quality);
  if (!rival->distance_m) return "rival '" + rival->scene + "'" + lead;
  return "a rival in '" + best.scene + "', " +
         print("%.2f m and %.0f deg away,",
               *rival->distance_m,
               *rival->turn_rad * 180.0 / std::numbers::pi) +
         lead;
}

std::string confidence_text(const Decision& decision,
                            std::span<const ExplainedCandidate> candidates) {
  const ExplainedCandidate& best = candidates.front();
  std::string text = "the best pose " + decision.verdict.lacks;
  const std::string rival = rival_text(candidates);
  if (!rival.empty()) text += "; " + rival;
  if (best.terms.empty() || !(best.terms[0].cost > 0.0)) return text;
  const ConfidenceTerm& worst = best.terms[0];
  return text + print("; what cost it most is %s: %.3f, %g would be ideal",
                      worst.name.c_str(),
                      worst.value,
                      worst.ideal);
}

// The stage, as the reason begins with it.
std::string stage_of(const std::string& reason) { return reason.substr(0, reason.find(':')); }

}  // namespace

Explanation explain(const Decision& decision) {
  Explanation explanation;
  explanation.funnel = funnel_of(decision);
  explanation.scenes = scene_funnels(decision);
  explanation.candidates = candidates_of(decision);
  explanation.remedies = find_remedies(decision);
  switch (decision.answer.status) {
    case QueryStatus::kLocalized:
      break;
    case QueryStatus::kAmbiguous:
      explanation.lost_at = "verify";
      explanation.why = rival_text(explanation.candidates);
      if (explanation.why.empty()) explanation.why = "the best pose " + decision.verdict.lacks;
      break;
    case QueryStatus::kNotFound:
      explanation.lost_at = stage_of(decision.answer.reason);
      explanation.why = explanation.candidates.empty()
                            ? decision.answer.reason
                            : confidence_text(decision, explanation.candidates);
      break;
  }
  return explanation;
}

Explanation explain_unsearched(const QueryResult& answer) {
  Explanation explanation;
  explanation.funnel = {{"points", answer.query.points}, {"used", answer.query.points_used}};
  explanation.lost_at = stage_of(answer.reason);
  explanation.why = answer.reason;
  return explanation;
}

}  // namespace landmarkdb
