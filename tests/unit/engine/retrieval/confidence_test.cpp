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
  evidence.contrast = 0.6;
  evidence.agreeing = 80.0;
  return evidence;
}

TEST(ConfidenceOf, RisesWithWhatSpeaksForAPoseAndFallsWithWhatSpeaksAgainst) {
  const Evidence evidence = convincing();
  const double base = confidence_of(evidence, 0.7, 0.3);
  EXPECT_GT(base, 0.0);
  EXPECT_LT(base, 1.0);
  EXPECT_GT(confidence_of(evidence, 0.7, 0.4), base);
  const auto less = [&](double Evidence::*figure, double value) {
    Evidence other = evidence;
    other.*figure = value;
    return confidence_of(other, 0.7, 0.3);
  };
  EXPECT_LT(less(&Evidence::contrast, 0.1), base);
  EXPECT_LT(less(&Evidence::observability, 0.0), base);
  EXPECT_LT(less(&Evidence::agreeing, 2.0), base);
  EXPECT_LT(less(&Evidence::contradicted, 0.05), base);
  EXPECT_LT(less(&Evidence::refuted, 0.02), base);
}

TEST(ConfidenceAlone, DoesNotLookAtRivals) {
  Evidence evidence = convincing();
  const double base = confidence_alone(evidence, 0.7);
  EXPECT_GT(base, 0.5);
  evidence.contrast = -1.0;
  EXPECT_EQ(confidence_alone(evidence, 0.7), base);
  evidence.explained = 0.7;
  EXPECT_LT(confidence_alone(evidence, 0.7), 0.5);
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
  Evidence nothing;
  nothing.contrast = 0.0;
  nothing.crossed = nothing.contradicted = nothing.refuted = 0.5;
  EXPECT_LT(confidence_of(nothing, 0.0, 1.0), 0.001);
  EXPECT_GT(confidence_of(convincing(), 0.9, 1.0), 0.9);
}

}  // namespace
}  // namespace landmarkdb
