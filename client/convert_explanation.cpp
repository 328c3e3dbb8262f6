#include <algorithm>
#include <cmath>
#include <string>

#include "client/convert.hpp"
#include "engine/geometry/quantise.hpp"

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

SceneView from_proto(const v1::SceneView& view) {
  constexpr std::uint64_t kBytesAPoint = 6;
  const v1::Cloud& cloud = view.cloud();
  if (cloud.encoding() != v1::POINT_ENCODING_INT16 || cloud.zstd() ||
      cloud.points() > kMostSceneViewPoints ||
      cloud.xyz().size() != kBytesAPoint * cloud.points() || !std::isfinite(cloud.scale_m())) {
    throw Error(ErrorCode::kInternal,
                "the server's scene view has " + std::to_string(cloud.xyz().size()) +
                    " bytes for " + std::to_string(cloud.points()) +
                    " points, want 6 a point, 16-bit and not compressed, at most " +
                    std::to_string(kMostSceneViewPoints) + " points");
  }
  const auto vector = [](const v1::Vector3& v) { return Eigen::Vector3d(v.x(), v.y(), v.z()); };
  SceneView out;
  out.points = dequantise({vector(cloud.offset_m()), cloud.scale_m(), cloud.xyz()});
  out.origin = vector(cloud.origin_m());
  out.scene_points = view.scene_points();
  out.spacing_m = view.spacing_m();
  out.whole = view.whole();
  if (view.has_up()) out.up = vector(view.up());
  return out;
}

}  // namespace landmarkdb::client
