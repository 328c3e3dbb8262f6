#include "engine/mono/recognize_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {
namespace {

// Fitted by `landmarkdb-bench-mono calibrate`, but for the constant: two lower than the fit, as a
// wrong answer costs more than a declined one. of the visible points, matches, rms, edge share
// where edges are known, and that they are known.
constexpr std::array<double, kConfidenceTerms> kWeights{
    -1.856, 0.955, 0.366, 1.696, 0.358, -2.674, 0.675, -1.519};

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
          e.has_edges ? e.edge_share : 0.0,
          e.has_edges ? 1.0 : 0.0};
}

double recognition_confidence(const RecognitionEvidence& evidence) {
  const std::array<double, kConfidenceTerms> terms = confidence_terms(evidence);
  double log_odds = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) log_odds += kWeights[i] * terms[i];
  // Corners of real things stand in rows and rectangles and fall into place more often than strewn
  // points do, but the edges between them do not: no answer is surer than its edges, short of
  // overwhelming evidence. On real pictures wrong poses had shares up to 0.75, right ones from
  // 0.80.
  constexpr double kEvenShare = 0.78, kSteepness = 25.0, kOverwhelming = -30.0;
  if (evidence.has_edges && evidence.log10_nfa > kOverwhelming) {
    log_odds = std::min(log_odds, kSteepness * (evidence.edge_share - kEvenShare));
  }
  return 1.0 / (1.0 + std::exp(-log_odds));
}

}  // namespace landmarkdb
