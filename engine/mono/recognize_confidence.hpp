#pragma once

namespace landmarkdb {

// What an answer's confidence is made of.
struct RecognitionEvidence {
  double log10_nfa = 0.0;
  double matched = 0.0;
  double visible = 0.0;
  double rms_px = 0.0;     // in pixels of a 640 pixels wide image
  bool has_edges = false;  // the image's edges are known
  double edge_share = 0.0;
  double margin = 0.0;  // in log10 of the number of false alarms
};

// The share of answers with this evidence that are right: a logistic function of the number of
// false alarms and the margin.
double recognition_confidence(const RecognitionEvidence& evidence);

}  // namespace landmarkdb
