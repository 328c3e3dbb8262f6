#include "engine/retrieval/object_confidence.hpp"

#include <gtest/gtest.h>

#include "engine/retrieval/confidence.hpp"

namespace landmarkdb {
namespace {

Evidence convincing() {
  Evidence evidence;
  evidence.of_object = true;
  evidence.overlap = 0.95;
  evidence.explained = 1.0;
  evidence.observability = 0.1;
  evidence.structure = 0.3;
  evidence.confirmed = 0.4;
  return evidence;
}

TEST(ObjectLogOdds, RisesWithWhatSpeaksForAPoseAndFallsWithWhatSpeaksAgainst) {
  const Evidence evidence = convincing();
  const double base = object_log_odds(evidence, 0.85, 0.3);
  EXPECT_GT(base, 0.0);
  EXPECT_GT(object_log_odds(evidence, 0.9, 0.3), base);
  EXPECT_GT(object_log_odds(evidence, 0.85, 0.4), base);
  const auto less = [&](double Evidence::*figure, double value) {
    Evidence other = evidence;
    other.*figure = value;
    return object_log_odds(other, 0.85, 0.3);
  };
  EXPECT_LT(less(&Evidence::structure, 0.05), base);
  EXPECT_LT(less(&Evidence::confirmed, 0.1), base);
  EXPECT_LT(less(&Evidence::outgrown, 0.2), base);
  EXPECT_LT(less(&Evidence::continued, 0.2), base);
}

TEST(ObjectLogOdds, AreWhatTheConfidenceOfAnObjectIsMadeOf) {
  const Evidence evidence = convincing();
  EXPECT_GT(confidence_of(evidence, 0.79, 0.3), 0.5);
  EXPECT_LT(confidence_of(evidence, 0.79, 0.0), 0.5);
  EXPECT_GT(confidence_alone(evidence, 0.79), confidence_of(evidence, 0.79, 0.0));
}

}  // namespace
}  // namespace landmarkdb
