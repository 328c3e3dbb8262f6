#include "engine/mono/recognize_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {
namespace {

// Fitted by `landmarkdb-bench-mono calibrate`: the constant, false alarms, margin, matches of the
// visible points, matches, rms, edge share; by points alone before the search by linked fours. The
// constants are lower than the fit, by two and by one, as a wrong answer costs more than a declined
// one.
constexpr std::array<double, kConfidenceTerms> kByPoints{
    -1.856, 0.955, 0.366, 1.696, 0.358, -2.674, 0.0};
constexpr std::array<double, kConfidenceTerms> kWithEdges{
    -5.561, 0.469, 0.631, 0.044, 0.285, -0.896, 1.193};

}  // namespace

std::array<double, kConfidenceTerms> confidence_terms(const RecognitionEvidence& e) {
  // Bounds: beyond them more of the same says no more, and one term cannot carry an answer.
  constexpr double kBestNfa = -12.0, kWorstNfa = 4.0, kLeastMargin = -4.0, kMostMargin = 6.0;
  constexpr double kMostMatches = 20.0, kMostRms_px = 4.0;
  return {1.0,
          -std::clamp(e.log10_nfa, kBestNfa, kWorstNfa),
          std::clamp(e.margin, kLeastMargin, kMostMargin),
          e.visible > 0.0 ? e.matched / e.visible : 0.0,
          std::min(e.matched, kMostMatches) / kMostMatches,
          std::min(e.rms_px, kMostRms_px),
          e.has_edges ? e.edge_share : 0.0};
}

double recognition_confidence(const RecognitionEvidence& evidence) {
  const std::array<double, kConfidenceTerms> terms = confidence_terms(evidence);
  const std::array<double, kConfidenceTerms>& weights = evidence.has_edges ? kWithEdges : kByPoints;
  double log_odds = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) log_odds += weights[i] * terms[i];
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace landmarkdb
