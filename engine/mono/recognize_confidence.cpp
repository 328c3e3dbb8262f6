#include "engine/mono/recognize_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {
namespace {

// Fitted by `landmarkdb-bench-mono calibrate`: the constant, false alarms, margin, matches of the
// visible points, matches, rms; proportions, edge share, whole edges, overrun ends. The constants
// are lower than the fit, by three and by 1.7, as a wrong answer costs more than a declined one:
// with edges one less accepts 173 instead of 152 of 400 known objects of rendered pictures (seed
// 600), and 6 instead of 3 wrong poses in 800.
constexpr std::array<double, kConfidenceTerms> kByPoints{
    -2.215, 1.526, 0.116, 4.072, 0.192, -2.647, 0.0, 0.0, 0.0, 0.0};
constexpr std::array<double, kConfidenceTerms> kWithEdges{
    -8.512, 0.337, 0.574, 0.383, 0.774, -0.781, 0.743, 1.635, 1.360, -0.836};

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
          .margin = hypothesis.margin};
}

std::array<double, kConfidenceTerms> confidence_terms(const RecognitionEvidence& e) {
  // Bounds: beyond them more of the same says no more, and one term cannot carry an answer.
  constexpr double kBestNfa = -12.0, kWorstNfa = 4.0, kLeastMargin = -4.0, kMostMargin = 6.0;
  constexpr double kMostMatches = 20.0, kMostRms_px = 4.0;
  constexpr double kLeastShapeOdds = -6.0, kMostShapeOdds = 4.0;
  return {1.0,
          -std::clamp(e.log10_nfa, kBestNfa, kWorstNfa),
          std::clamp(e.margin, kLeastMargin, kMostMargin),
          e.visible > 0.0 ? e.matched / e.visible : 0.0,
          std::min(e.matched, kMostMatches) / kMostMatches,
          std::min(e.rms_px, kMostRms_px),
          e.has_edges ? std::clamp(e.shape_odds, kLeastShapeOdds, kMostShapeOdds) : 0.0,
          e.has_edges ? e.edge_share : 0.0,
          e.has_edges ? e.edges.whole : 0.0,
          e.has_edges ? e.edges.overrun : 0.0};
}

double recognition_confidence(const RecognitionEvidence& evidence) {
  const std::array<double, kConfidenceTerms> terms = confidence_terms(evidence);
  const std::array<double, kConfidenceTerms>& weights = evidence.has_edges ? kWithEdges : kByPoints;
  double log_odds = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) log_odds += weights[i] * terms[i];
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace landmarkdb
