#include "bench/retrieval/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/unit/bench/retrieval/synthetic_samples.hpp"

namespace landmarkdb::bench {

namespace {

using testing::HasSubstr;

Samples some_samples() {
  Samples samples = synthetic_samples(Eigen::Vector3d(0.5, 2.0, -1.0), 2000, 20, 11);
  samples.names = {"constant", "margin", "explained"};
  samples.without_pose = 100;
  return samples;
}

TEST(Calibrate, AddsUp) {
  const Calibration result = calibrate(some_samples(), {});
  EXPECT_EQ(result.queries(), 2100U);
  EXPECT_EQ(result.places, 20U);
  EXPECT_EQ(result.right + result.wrong, 2000U);
  std::size_t rows = 0;
  for (const ReliabilityBin& bin : result.reliability) rows += bin.count;
  EXPECT_EQ(rows, 2000U);
  ASSERT_EQ(result.accepted.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_LE(result.accepted[i].right, result.accepted[i - 1].right);
    EXPECT_LE(result.accepted[i].wrong, result.accepted[i - 1].wrong);
  }
}

TEST(Calibrate, MeansWhatItSaysWhereTheModelIsTheTruth) {
  const Calibration result = calibrate(some_samples(), {});
  for (const ReliabilityBin& bin : result.reliability) {
    EXPECT_NEAR(bin.mean_confidence, bin.share_right(), 0.12) << bin.low;
  }
  EXPECT_GT(result.area_under_roc, 0.85);
  EXPECT_LT(result.log_loss, 0.45);
}

TEST(Calibrate, GrowsStricterWhenWrongRowsCountForMore) {
  const Calibration plain = calibrate(some_samples(), {});
  const Calibration strict = calibrate(some_samples(), {.wrong_weight = 5.0});
  EXPECT_LT(strict.accepted[0].wrong, plain.accepted[0].wrong);
}

TEST(CalibrationText, HoldsTheWeightsAsRowsOfATable) {
  Calibration calibration = calibrate(some_samples(), {});
  calibration.weights = Eigen::Vector3d(-1.25, 2.0, 3.5);
  EXPECT_THAT(calibration_text(calibration),
              HasSubstr("    {\"constant\", -1.2500},\n"
                        "    {\"margin\", 2.0000},  // min(margin, 0.4)\n"
                        "    {\"explained\", 3.5000},\n"));
}

TEST(CalibrationText, SaysWhatShareOfAllQueriesIsWrong) {
  Calibration calibration;
  calibration.right = 150;
  calibration.wrong = 40;
  calibration.without_pose = 10;
  calibration.accepted = {{0.7, 120, 5}};
  EXPECT_THAT(calibration_text(calibration),
              HasSubstr("     0.70    120 of 150         5 of 40        2.50 %\n"));
}

TEST(CalibrationJson, HoldsWhatTheTextDoes) {
  const Calibration calibration = calibrate(some_samples(), {});
  const auto json = nlohmann::json::parse(calibration_json(calibration));
  EXPECT_EQ(json["queries"], 2100);
  EXPECT_EQ(json["weights"][1]["name"], "margin");
  EXPECT_DOUBLE_EQ(json["weights"][1]["weight"].get<double>(), calibration.weights[1]);
  EXPECT_EQ(json["held_out"]["accepted"].size(), 4U);
  EXPECT_EQ(json["held_out"]["reliability"].size(), 10U);
  EXPECT_DOUBLE_EQ(json["held_out"]["log_loss"].get<double>(), calibration.log_loss);
}

}  // namespace

}  // namespace landmarkdb::bench
