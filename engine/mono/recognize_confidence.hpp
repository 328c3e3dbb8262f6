#pragma once

#include <array>
#include <cstddef>

#include "engine/types/recognition.hpp"

namespace landmarkdb {

// What an answer's confidence is made of.
struct RecognitionEvidence {
  double log10_nfa = 0.0;
  double matched = 0.0;
  double visible = 0.0;
  double rms_px = 0.0;     // in pixels of a 640 pixels wide image
  bool has_edges = false;  // the image's edges are known
  double edge_share = 0.0;
  EdgeEvidence edges{};
  double shape_odds = 0.0;  // stretched_rival
  double face_odds = 0.0;   // face_rival
  double margin = 0.0;      // in log10 of the number of false alarms
};

// Of an image 640 pixels wide.
RecognitionEvidence evidence_of(const MonoHypothesis& hypothesis, bool has_edges);

// The terms whose weighted sum is the log odds of being right; the first is 1, those after
// kPointTerms are 0 where the image's edges are not known.
inline constexpr std::size_t kConfidenceTerms = 12, kPointTerms = 6;
std::array<double, kConfidenceTerms> confidence_terms(const RecognitionEvidence& evidence);

// The share of answers with this evidence that are right: a logistic function of the terms, with
// weights of its own where edges are known. `landmarkdb-bench-mono calibrate` fits them, to
// rendered pictures and generated scenes with and without a known object
// (docs/decisions/0012-monocular-confidence.md and 0017).
double recognition_confidence(const RecognitionEvidence& evidence);

}  // namespace landmarkdb
