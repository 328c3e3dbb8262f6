#include "server/convert_explanation.hpp"

#include <utility>

#include "engine/geometry/pose.hpp"
#include "engine/geometry/quantise.hpp"
#include "server/convert_cloud.hpp"

namespace landmarkdb {

namespace {

void put(const FunnelStep& step, v1::FunnelStep& out) {
  out.set_name(step.name);
  out.set_count(step.count);
}

v1::CandidateRole role_number(CandidateRole role) {
  switch (role) {
    case CandidateRole::kBest:
      return v1::CANDIDATE_ROLE_BEST;
    case CandidateRole::kRival:
      return v1::CANDIDATE_ROLE_RIVAL;
    case CandidateRole::kBehind:
      return v1::CANDIDATE_ROLE_BEHIND;
  }
  return v1::CANDIDATE_ROLE_UNSPECIFIED;
}

void put(const ExplainedCandidate& candidate, v1::ExplainedCandidate& out) {
  out.set_scene(candidate.scene);
  out.set_role(role_number(candidate.role));
  for (const double number : to_row_major(candidate.T_scene_sensor)) {
    out.add_t_scene_sensor(number);
  }
  out.set_confidence(candidate.confidence);
  out.set_quality(candidate.quality);
  out.set_overlap(candidate.overlap);
  out.set_explained(candidate.explained);
  out.set_free_space_violation(candidate.crossed);
  out.set_coverage(candidate.coverage);
  out.set_observability(candidate.observability);
  out.set_margin(candidate.margin);
  for (const double number : candidate.deviation) out.add_deviation(number);
  if (candidate.distance_m) out.set_distance_m(*candidate.distance_m);
  if (candidate.turn_rad) out.set_turn_rad(*candidate.turn_rad);
  for (const ConfidenceTerm& term : candidate.terms) {
    v1::ConfidenceTerm& one = *out.add_terms();
    one.set_name(term.name);
    one.set_value(term.value);
    one.set_ideal(term.ideal);
    one.set_cost(term.cost);
    one.set_worth(term.worth);
  }
}

}  // namespace

v1::Explanation to_proto(const Explanation& explanation) {
  v1::Explanation out;
  for (const FunnelStep& step : explanation.funnel) put(step, *out.add_funnel());
  for (const SceneFunnel& scene : explanation.scenes) {
    v1::SceneFunnel& one = *out.add_scenes();
    one.set_scene(scene.scene);
    for (const FunnelStep& step : scene.steps) put(step, *one.add_steps());
    one.set_best_quality(scene.best_quality);
  }
  for (const ExplainedCandidate& candidate : explanation.candidates) {
    put(candidate, *out.add_candidates());
  }
  out.set_lost_at(explanation.lost_at);
  out.set_why(explanation.why);
  for (const Remedy& remedy : explanation.remedies) {
    v1::Remedy& one = *out.add_remedies();
    one.set_option(remedy.option);
    one.set_value(remedy.value);
    one.set_effect(remedy.effect);
  }
  return out;
}

v1::SceneView to_proto(const SceneView& view) {
  v1::SceneView out;
  QuantisedPoints points = quantise(view.points);
  v1::Cloud& cloud = *out.mutable_cloud();
  cloud.set_encoding(v1::POINT_ENCODING_INT16);
  cloud.set_points(view.points.size());
  cloud.set_xyz(std::move(points.bytes));
  cloud.set_scale_m(points.scale_m);
  *cloud.mutable_offset_m() = to_proto(points.offset_m);
  *cloud.mutable_origin_m() = to_proto(view.origin);
  out.set_scene_points(view.scene_points);
  out.set_spacing_m(view.spacing_m);
  out.set_whole(view.whole);
  if (view.up) *out.mutable_up() = to_proto(*view.up);
  return out;
}

}  // namespace landmarkdb
