#include "engine/mono/answer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "engine/mono/recognize_confidence.hpp"

namespace landmarkdb {
namespace {

constexpr double kNoRival = 10.0;  // margin where nothing else came up
// log10 of false alarms; landmarkdb-bench-mono has known objects from +2.9 and mirrored ones to
// -8.9.
constexpr double kMirrorDecides = 1.0;
constexpr double kWorthTelling = 0.05;  // confidence of a further hypothesis

// Whether two candidates want the same image points: a quarter of the smaller one's.
bool contend(const MonoCandidate& a, const MonoCandidate& b) {
  std::size_t shared = 0;
  for (const Match& match : a.matches) {
    shared += std::any_of(b.matches.begin(),
                          b.matches.end(),
                          [&](const Match& other) { return other.image == match.image; })
                  ? 1
                  : 0;
  }
  return 4 * shared >= std::min(a.matches.size(), b.matches.size());
}

double margin_of(std::span<const MonoCandidate> candidates, std::size_t which) {
  double margin = kNoRival;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (i == which || !contend(candidates[i], candidates[which])) continue;
    margin = std::min(margin, candidates[i].rank() - candidates[which].rank());
  }
  return margin;
}

MonoHypothesis told(const SearchModel& search,
                    const ImageView& image,
                    const MonoCandidate& candidate) {
  MonoHypothesis hypothesis;
  hypothesis.model = search.model().name;
  hypothesis.T_camera_object = candidate.pose.isometry();
  hypothesis.covariance = candidate.covariance;
  hypothesis.model_points = search.points.size();
  hypothesis.visible_points = candidate.visible;
  hypothesis.rms_px = candidate.rms_px;
  hypothesis.log10_nfa = candidate.rank();
  hypothesis.edge_share = candidate.edge_share;
  hypothesis.edges = candidate.edges;
  hypothesis.shape_odds = candidate.shape_odds;
  hypothesis.face_odds = candidate.face_odds;
  hypothesis.symmetry = search.model().symmetry_class;
  hypothesis.ambiguous = candidate.ambiguous;
  for (const Match& match : candidate.matches) {
    hypothesis.pairs.push_back({match.model, image[match.image].source, match.distance_px});
  }
  std::sort(hypothesis.pairs.begin(),
            hypothesis.pairs.end(),
            [](const MonoPair& a, const MonoPair& b) { return a.model < b.model; });
  return hypothesis;
}

std::string why_not(std::span<const MonoHypothesis> hypotheses, double min_confidence) {
  if (hypotheses.empty()) return "no pose of any model explains five of the image's feature points";
  const MonoHypothesis& best = hypotheses.front();
  char text[200];
  const char* why = best.ambiguous      ? ", two tilts of its plane fit about as well"
                    : best.margin < 1.0 ? ", something else explains its points about as well"
                                        : "";
  std::snprintf(
      text,
      sizeof text,
      "the best hypothesis matches %zu of %zu visible points at confidence %.2f, want %.2f%s",
      best.pairs.size(),
      best.visible_points,
      best.confidence,
      min_confidence,
      why);
  return text;
}

}  // namespace

void write_answer(std::span<const SearchModel> models,
                  const ImageView& image,
                  const EdgeGrid& edges,
                  std::span<const MonoCandidate> candidates,
                  const RecognizeOptions& options,
                  double scale,
                  RecognizeResult& result) {
  std::vector<MonoHypothesis> hypotheses;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const MonoCandidate& candidate = candidates[i];
    MonoHypothesis hypothesis = told(models[candidate.model], image, candidate);
    hypothesis.margin = margin_of(candidates, i);
    // A mirror image that does not explain it clearly better is no rival: it is in no catalogue,
    // and that of a symmetric model is the model.
    if (candidate.mirror_margin.value_or(0.0) < -kMirrorDecides)
      hypothesis.margin = std::min(hypothesis.margin, *candidate.mirror_margin);
    RecognitionEvidence evidence = evidence_of(hypothesis, !edges.empty());
    evidence.rms_px /= scale;
    hypothesis.confidence = recognition_confidence(evidence);
    // The rival has its part of it: the odds of the two are those of their false alarms.
    hypothesis.confidence /= 1.0 + std::pow(10.0, -hypothesis.margin);
    if (candidate.ambiguous) {
      MonoHypothesis twin = hypothesis;
      twin.T_camera_object = candidate.twin.isometry();
      twin.confidence *= candidate.twin_odds / (1.0 + candidate.twin_odds);
      hypothesis.confidence /= 1.0 + candidate.twin_odds;
      hypotheses.push_back(hypothesis);
      hypotheses.push_back(twin);
    } else {
      hypotheses.push_back(hypothesis);
    }
  }
  std::stable_sort(
      hypotheses.begin(), hypotheses.end(), [](const MonoHypothesis& a, const MonoHypothesis& b) {
        return a.confidence > b.confidence;
      });
  const std::size_t least = options.top > 0 ? 1 : 0;
  while (hypotheses.size() > least &&
         (hypotheses.size() > options.top || hypotheses.back().confidence < kWorthTelling)) {
    hypotheses.pop_back();
  }
  const bool recognized =
      !hypotheses.empty() && hypotheses.front().confidence >= options.min_confidence;
  result.status = recognized ? RecognizeStatus::kRecognized : RecognizeStatus::kNotFound;
  if (!recognized) result.reason = why_not(hypotheses, options.min_confidence);
  result.hypotheses = std::move(hypotheses);
}

}  // namespace landmarkdb
