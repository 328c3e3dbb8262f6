#include "engine/mono/recognize_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {
namespace {

// Fitted by `landmarkdb-bench-mono --pictures 800 calibrate`: the constant, false alarms, margin,
// matches of the visible points, matches, rms; proportions, overrun ends, supported edges, edges on
// lines, bend, faces. The constants are lower than the fit, by three and by 1.7, as a wrong answer
// costs more than a declined one: with edges one less accepts 162 instead of 147 of 400 known
// objects of rendered pictures (seeds 100 to 115), and 6 instead of 4 wrong poses in 800.
constexpr std::array<double, kConfidenceTerms> kByPoints{
    -2.215, 1.526, 0.116, 4.072, 0.192, -2.647, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
constexpr std::array<double, kConfidenceTerms> kWithEdges{
    -8.534, 0.226, 0.537, 0.988, 0.623, -0.509, 0.714, -0.926, 0.995, 1.746, -0.537, 0.437};

}  // namespace

RecognitionEvidence evidence_of(const MonoHypothesis& hypothesis, bool has_edges) {
  return {.log10_nfa = hypothesis.log10_nfa,
          .matched = static_cast<double>(hypothesis.pairs.size()),
          .visible = static_cast<double>(hypothesis.visible_points),
          .rms_px = hypothesis.rms_px,
          .has_edges = has_edges,
          .edge_share = hypothesis.edge_share,
          .edges = hypothesis.edges,
          .shape_odds = hypothesis.shape_odds,
          .face_odds = hypothesis.face_odds,
          .margin = hypothesis.margin};
}

std::array<double, kConfidenceTerms> confidence_terms(const RecognitionEvidence& e) {
  // Bounds: beyond them more of the same says no more, and one term cannot carry an answer.
  constexpr double kBestNfa = -12.0, kWorstNfa = 4.0, kLeastMargin = -4.0, kMostMargin = 6.0;
  constexpr double kMostMatches = 20.0, kMostRms_px = 4.0;
  constexpr double kLeastShapeOdds = -6.0, kMostShapeOdds = 4.0;
  constexpr double kMostLined = 12.0, kMostBend = 4.0;
  // Faces speak for a model as far as its edges are there, and its points meet the image's.
  constexpr double kLeastFaceOdds = -4.0, kMostFaceOdds = 6.0, kOverPoints = 4.0;
  const double faces =
      std::clamp(std::min(e.face_odds, kOverPoints - e.log10_nfa), kLeastFaceOdds, kMostFaceOdds);
  return {1.0,
          -std::clamp(e.log10_nfa, kBestNfa, kWorstNfa),
          std::clamp(e.margin, kLeastMargin, kMostMargin),
          e.visible > 0.0 ? e.matched / e.visible : 0.0,
          std::min(e.matched, kMostMatches) / kMostMatches,
          std::min(e.rms_px, kMostRms_px),
          e.has_edges ? std::clamp(e.shape_odds, kLeastShapeOdds, kMostShapeOdds) : 0.0,
          e.has_edges ? e.edges.overrun : 0.0,
          e.has_edges ? e.edges.supported : 0.0,
          e.has_edges ? std::min(e.edges.lined, kMostLined) / kMostLined : 0.0,
          e.has_edges ? std::min(e.edges.bend, kMostBend) : 0.0,
          e.has_edges ? faces * e.edges.supported : 0.0};
}

double recognition_confidence(const RecognitionEvidence& evidence) {
  const std::array<double, kConfidenceTerms> terms = confidence_terms(evidence);
  const std::array<double, kConfidenceTerms>& weights = evidence.has_edges ? kWithEdges : kByPoints;
  double log_odds = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) log_odds += weights[i] * terms[i];
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace landmarkdb
