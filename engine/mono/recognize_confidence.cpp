#include "engine/mono/recognize_confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {

double recognition_confidence(const RecognitionEvidence& e) {
  const double z =
      -6.0 - 1.2 * std::clamp(e.log10_nfa, -12.0, 4.0) + 0.5 * std::clamp(e.margin, -4.0, 6.0);
  return 1.0 / (1.0 + std::exp(-z));
}

}  // namespace landmarkdb
