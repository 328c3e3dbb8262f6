#include "engine/retrieval/confidence.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {

// Started from a logistic regression on 80 frames of eight generated places, two of them not in the
// catalogue, then made stricter where a wrong pose came through: a lead counts for more, and the
// constant is lower, since a wrong pose costs more than a right one declined. No calibration yet: a
// high figure means what it says, one near a half is on the safe side.
double confidence_of(const Evidence& evidence, double quality, double margin) {
  constexpr double kFullMargin = 0.4;          // a larger lead proves no more
  constexpr double kFullObservability = 0.05;  // likewise
  const double lead = std::min(margin, kFullMargin);
  const double observed = std::min(1.0, evidence.observability / kFullObservability);
  const double z = -28.2 + 1.3 * quality + 20.0 * lead - 2.0 * evidence.crossed + 5.0 * observed +
                   4.6 * evidence.coverage + 13.3 * evidence.explained;
  return 1.0 / (1.0 + std::exp(-z));
}

}  // namespace landmarkdb
