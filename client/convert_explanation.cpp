#include <algorithm>
#include <string>

#include "client/convert.hpp"

namespace landmarkdb::client {
namespace {

FunnelStep step(const v1::FunnelStep& message) {
  return {.name = message.name(), .count = message.count()};
}

CandidateRole role(v1::CandidateRole number) {
  switch (number) {
    case v1::CANDIDATE_ROLE_BEST:
      return CandidateRole::kBest;
    case v1::CANDIDATE_ROLE_RIVAL:
      return CandidateRole::kRival;
    default:
      return CandidateRole::kBehind;
  }
}

void want(int seen, int wanted, const char* field) {
  if (seen == wanted) return;
  throw Error(ErrorCode::kInternal,
              std::string("the server's ") + field + " has " + std::to_string(seen) +
                  " numbers, want " + std::to_string(wanted));
}

ExplainedCandidate candidate(const v1::ExplainedCandidate& message) {
  want(message.t_scene_sensor_size(), 16, "t_scene_sensor");
  want(message.deviation_size(), 6, "deviation");
  ExplainedCandidate out;
  out.scene = message.scene();
  out.role = role(message.role());
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  out.T_scene_sensor = Eigen::Map<const RowMajor>(message.t_scene_sensor().data());
  out.confidence = message.confidence();
  out.quality = message.quality();
  out.overlap = message.overlap();
  out.explained = message.explained();
  out.crossed = message.free_space_violation();
  out.coverage = message.coverage();
  out.observability = message.observability();
  out.margin = message.margin();
  std::copy(message.deviation().begin(), message.deviation().end(), out.deviation.data());
  if (message.has_distance_m()) out.distance_m = message.distance_m();
  if (message.has_turn_rad()) out.turn_rad = message.turn_rad();
  for (const v1::ConfidenceTerm& term : message.terms()) {
    out.terms.push_back({.name = term.name(),
                         .value = term.value(),
                         .ideal = term.ideal(),
                         .worth = term.worth(),
                         .cost = term.cost()});
  }
  return out;
}

}  // namespace

Explanation from_proto(const v1::Explanation& explanation) {
  Explanation out;
  for (const v1::FunnelStep& one : explanation.funnel()) out.funnel.push_back(step(one));
  for (const v1::SceneFunnel& scene : explanation.scenes()) {
    SceneFunnel& one = out.scenes.emplace_back();
    one.scene = scene.scene();
    for (const v1::FunnelStep& s : scene.steps()) one.steps.push_back(step(s));
    one.best_quality = scene.best_quality();
  }
  for (const v1::ExplainedCandidate& one : explanation.candidates()) {
    out.candidates.push_back(candidate(one));
  }
  out.lost_at = explanation.lost_at();
  out.why = explanation.why();
  for (const v1::Remedy& one : explanation.remedies()) {
    out.remedies.push_back({.option = one.option(), .value = one.value(), .effect = one.effect()});
  }
  return out;
}

}  // namespace landmarkdb::client
