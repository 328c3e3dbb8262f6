#include "engine/retrieval/confidence.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

Evidence convincing() {
  Evidence evidence;
  evidence.overlap = 0.9;
  evidence.balanced = 0.9;
  evidence.explained = 0.95;
  evidence.crossed = 0.01;
  evidence.coverage = 0.95;
  evidence.observability = 0.1;
  return evidence;
}

TEST(ConfidenceOf, RisesWithWhatSpeaksForAPoseAndFallsWithWhatSpeaksAgainst) {
  const Evidence evidence = convincing();
  const double base = confidence_of(evidence, 0.7, 0.3);
  EXPECT_GT(base, 0.0);
  EXPECT_LT(base, 1.0);
  EXPECT_GT(confidence_of(evidence, 0.8, 0.3), base);
  EXPECT_GT(confidence_of(evidence, 0.7, 0.4), base);
  Evidence less = evidence;
  less.explained = 0.8;
  EXPECT_LT(confidence_of(less, 0.7, 0.3), base);
  less = evidence;
  less.coverage = 0.5;
  EXPECT_LT(confidence_of(less, 0.7, 0.3), base);
  less = evidence;
  less.crossed = 0.2;
  EXPECT_LT(confidence_of(less, 0.7, 0.3), base);
  less = evidence;
  less.observability = 0.0;
  EXPECT_LT(confidence_of(less, 0.7, 0.3), base);
}

TEST(ConfidenceOf, IsAProbabilityForAnyEvidence) {
  for (const double share : {0.0, 0.5, 1.0}) {
    Evidence evidence;
    evidence.explained = evidence.coverage = evidence.observability = share;
    evidence.crossed = 1.0 - share;
    for (const double quality : {0.0, 1.0}) {
      for (const double margin : {0.0, 1.0}) {
        const double confidence = confidence_of(evidence, quality, margin);
        EXPECT_GE(confidence, 0.0);
        EXPECT_LE(confidence, 1.0);
      }
    }
  }
  EXPECT_LT(confidence_of(Evidence{}, 0.0, 1.0), 0.001);
  EXPECT_GT(confidence_of(convincing(), 0.9, 1.0), 0.9);
}

}  // namespace
}  // namespace landmarkdb
