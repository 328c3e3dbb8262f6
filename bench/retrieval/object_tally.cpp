#include "bench/retrieval/object_tally.hpp"

#include <algorithm>
#include <cstdio>

#include "bench/retrieval/pose_errors.hpp"

namespace landmarkdb::bench {

namespace {

bool to_be_found(const datasets::Standing& thing) {
  return thing.unhidden >= kLeastUnhidden && thing.pixels >= kLeastPixels;
}

bool within(double metres, double degrees, double extent_m) {
  return metres <= std::min(kRightMetres, kRightShareOfExtent * extent_m) &&
         degrees <= kRightDegrees;
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

JudgedHypothesis judge_hypothesis(const Hypothesis& hypothesis, const AskedScene& asked) {
  JudgedHypothesis judged;
  const Eigen::Isometry3d T_object_sensor(hypothesis.T_scene_sensor);
  const Eigen::Isometry3d estimate = asked.scene.frame.T_scene_camera * T_object_sensor.inverse();
  for (std::size_t i = 0; i < asked.scene.things.size(); ++i) {
    const datasets::Standing& thing = asked.scene.things[i];
    const datasets::ObjectModel& model = *asked.models[thing.model];
    if (thing.model >= asked.known || model.name != hypothesis.scene) continue;
    const auto error = datasets::object_error(model, thing.T_scene_object, estimate);
    if (error.metres > judged.metres) continue;
    judged = {
        .right = within(error.metres, error.degrees, model.extent_m),
        .right_symmetric = within(error.symmetric_metres, error.symmetric_degrees, model.extent_m),
        .metres = error.metres,
        .degrees = error.degrees,
        .unhidden = thing.unhidden,
        .pixels = thing.pixels,
        .thing = i};
  }
  return judged;
}

void ObjectTally::add(const QueryResult& answer, const AskedScene& asked) {
  constexpr double kClaim = 0.5;
  milliseconds.push_back(answer.timings.total.count());
  bool shows = false;
  bool any = false;
  std::vector<char> thing_listed(asked.scene.things.size(), 0);
  std::vector<char> thing_claimed(asked.scene.things.size(), 0);
  bool first = false;
  for (std::size_t h = 0; h < answer.hypotheses.size(); ++h) {
    const JudgedHypothesis judged = judge_hypothesis(answer.hypotheses[h], asked);
    const bool claim = answer.hypotheses[h].confidence >= kClaim;
    if (h == 0) first = judged.right_symmetric;
    if (claim) ++claims;
    if (claim && !judged.right_symmetric) ++false_claims;
    if (!judged.right_symmetric) continue;
    thing_listed[judged.thing] = 1;
    if (claim) thing_claimed[judged.thing] = 1;
    if (h != 0 || answer.status != QueryStatus::kLocalized) continue;
    metres.push_back(judged.metres);
    degrees.push_back(judged.degrees);
  }
  for (std::size_t i = 0; i < asked.scene.things.size(); ++i) {
    if (asked.scene.things[i].model >= asked.known) continue;
    any = true;
    if (!to_be_found(asked.scene.things[i])) continue;
    shows = true;
    ++instances;
    listed += static_cast<std::size_t>(thing_listed[i]);
    claimed += static_cast<std::size_t>(thing_claimed[i]);
  }
  const bool localized = answer.status == QueryStatus::kLocalized;
  const bool ambiguous = answer.status == QueryStatus::kAmbiguous;
  if (shows) {
    ++shown;
    shown_first += first ? 1U : 0U;
    shown_right += localized && first ? 1U : 0U;
    shown_wrong += localized && !first ? 1U : 0U;
    shown_ambiguous += ambiguous ? 1U : 0U;
  } else if (any) {
    ++part;
    part_right += localized && first ? 1U : 0U;
    part_wrong += localized && !first ? 1U : 0U;
  } else {
    ++none;
    none_wrong += localized ? 1U : 0U;
    none_ambiguous += ambiguous ? 1U : 0U;
  }
}

std::string object_tally_text(const ObjectTally& t) {
  char text[900];
  std::snprintf(
      text,
      sizeof text,
      "with an instance to be found  %4zu: first %5.1f %%, localized right %5.1f %%, wrong %zu, "
      "ambiguous %zu\n"
      "with hidden ones alone        %4zu: localized right %zu, wrong %zu\n"
      "with none                     %4zu: localized (wrong) %zu, ambiguous %zu\n"
      "instances to be found         %4zu: listed %5.1f %%, with confidence 0.5 %5.1f %%\n"
      "claims of confidence 0.5      %4zu: false %zu\n"
      "all queries                   %4zu: localized wrong %.2f %%, median %.0f ms; right ones "
      "%.1f mm, %.2f deg\n",
      t.shown,
      percent(t.shown_first, t.shown),
      percent(t.shown_right, t.shown),
      t.shown_wrong,
      t.shown_ambiguous,
      t.part,
      t.part_right,
      t.part_wrong,
      t.none,
      t.none_wrong,
      t.none_ambiguous,
      t.instances,
      percent(t.listed, t.instances),
      percent(t.claimed, t.instances),
      t.claims,
      t.false_claims,
      t.milliseconds.size(),
      percent(t.shown_wrong + t.part_wrong + t.none_wrong, t.milliseconds.size()),
      median(t.milliseconds),
      1000.0 * median(t.metres),
      median(t.degrees));
  return text;
}

}  // namespace landmarkdb::bench
