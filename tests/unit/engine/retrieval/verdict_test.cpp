#include "engine/retrieval/verdict.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;

// Entries that are there for their cell size only.
std::vector<Entry> entries(std::size_t count, double cell_m, EntryKind kind = EntryKind::kPlace) {
  std::vector<Entry> made;
  for (std::size_t i = 0; i < count; ++i) {
    auto record = std::make_shared<SceneRecord>();
    record->name = "place-" + std::to_string(i);
    record->prepared.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    record->prepared.normals.assign(4, Eigen::Vector3f::UnitZ());
    record->prepared.resolution_m = cell_m;
    record->kind = kind;
    CatalogEntry stored;
    stored.record = std::move(record);
    made.push_back(make_entry(std::move(stored)));
  }
  return made;
}

// A pose with the evidence of a right one.
Assessed good(std::size_t entry, const Eigen::Vector3d& t, double score) {
  Assessed pose;
  pose.entry = entry;
  pose.T_entry_sensor.translation() = t;
  pose.score = score;
  pose.evidence.overlap = 0.9;
  pose.evidence.balanced = 0.9;
  pose.evidence.explained = 0.97;
  pose.evidence.crossed = 0.01;
  pose.evidence.coverage = 0.95;
  pose.evidence.observability = 0.1;
  return pose;
}

Assessed poor(std::size_t entry, const Eigen::Vector3d& t, double score) {
  Assessed pose = good(entry, t, score);
  pose.evidence.overlap = 0.3;
  pose.evidence.explained = 0.4;
  pose.evidence.crossed = 0.5;
  pose.evidence.contradicted = 0.4;
  pose.evidence.observability = 0.0;
  return pose;
}

const Eigen::Vector3d kZero = Eigen::Vector3d::Zero();

TEST(Judge, LocalizesAGoodPoseWithoutRival) {
  const Verdict verdict =
      judge({poor(0, {5, 0, 0}, 0.2), good(0, kZero, 0.8)}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(verdict.status, QueryStatus::kLocalized);
  EXPECT_EQ(verdict.reason, "");
  ASSERT_EQ(verdict.judged.size(), 2U);
  EXPECT_EQ(verdict.judged[0].pose.score, 0.8);
  EXPECT_GT(verdict.judged[0].margin, 0.3);
  EXPECT_LE(verdict.judged[0].margin, 1.0 - 0.2 / 0.8);
  EXPECT_GE(verdict.judged[0].confidence, 0.5);
  EXPECT_EQ(verdict.judged[1].margin, 0.0);
  EXPECT_LT(verdict.judged[1].confidence, verdict.judged[0].confidence);
}

TEST(Judge, CallsARivalElsewhereAmbiguousAndListsBoth) {
  const Verdict verdict =
      judge({good(0, {5, 0, 0}, 0.79), good(0, kZero, 0.8)}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(verdict.status, QueryStatus::kAmbiguous);
  ASSERT_EQ(verdict.judged.size(), 2U);
  EXPECT_EQ(verdict.judged[0].pose.score, 0.8);
  EXPECT_LT(verdict.judged[0].margin, 0.02);
}

TEST(Judge, MarksTheRivalsAndNoOther) {
  const Verdict verdict =
      judge({good(0, {5, 0, 0}, 0.79), good(0, kZero, 0.8), good(0, {0, 5, 0}, 0.5)},
            entries(1, 0.05),
            kZero,
            {});
  ASSERT_EQ(verdict.judged.size(), 3U);
  EXPECT_FALSE(verdict.judged[0].rival) << "the best is none of its own";
  EXPECT_TRUE(verdict.judged[1].rival);
  EXPECT_FALSE(verdict.judged[2].rival);
}

// Two poses that were compared point by point: `contrast` speaks for the first.
std::vector<Assessed> compared(Assessed best, Assessed rival, float contrast) {
  best.id = 0;
  rival.id = 1;
  best.contrast = {0.0F, contrast};
  rival.contrast = {-contrast, 0.0F};
  return {best, rival};
}

TEST(Judge, SaysWhatTheBestPoseLacks) {
  const std::vector<Entry> place = entries(1, 0.05);
  const auto lacks = [&](std::vector<Assessed> poses) {
    return judge(std::move(poses), place, kZero, {}).lacks;
  };
  Assessed sure = good(0, kZero, 0.8);
  sure.evidence.agreeing = 300.0;
  EXPECT_EQ(lacks({sure}), "");
  EXPECT_THAT(lacks({poor(0, kZero, 0.2)}), HasSubstr("has confidence 0.42, wanted 0.50"));
  EXPECT_THAT(lacks(compared(sure, good(0, {5, 0, 0}, 0.76), 0.9F)),
              HasSubstr("rival of 95.0 % of its quality, wanted less than 93 %"));
  sure.evidence.observability = 0.004;
  EXPECT_THAT(lacks({sure}), HasSubstr("observability 0.0040, wanted 0.006"));
}

TEST(Judge, TakesNoPoseThatHasAnEqualOrSlides) {
  Assessed best = good(0, kZero, 0.8);
  best.evidence.agreeing = 300.0;
  Assessed rival = good(0, {5, 0, 0}, 0.73);  // 91 % of the best one's score
  const auto told = [&](float contrast) {
    return judge(compared(best, rival, contrast), entries(1, 0.05), kZero, {});
  };
  EXPECT_EQ(told(0.9F).status, QueryStatus::kLocalized);
  rival.score = 0.76;  // 95 %
  EXPECT_EQ(told(0.9F).status, QueryStatus::kAmbiguous);
  EXPECT_GE(told(0.9F).judged[0].confidence, 0.5) << "sure, and still ambiguous";
  rival.score = 0.73;
  EXPECT_LT(told(-0.9F).judged[0].confidence, told(0.9F).judged[0].confidence);
  best.evidence.observability = 0.005;
  EXPECT_NE(told(0.9F).status, QueryStatus::kLocalized);
}

TEST(Judge, TakesAPlaceThatIsHeldFasterThanByALoneWall) {
  const auto made = entries(1, 0.05);
  Assessed best = good(0, kZero, 0.9);
  best.evidence.agreeing = 200.0;
  best.evidence.contrast = 0.5;
  best.evidence.observability = 0.008;
  EXPECT_EQ(judge({best}, made, kZero, {}).status, QueryStatus::kLocalized);
}

TEST(Judge, TakesNoPoseThatTheViewTheScannerOrThePointsSpeakAgainst) {
  const auto verdict = [&](double contradicted, double refuted, float contrast) {
    Assessed best = good(0, kZero, 0.8);
    best.evidence.agreeing = 12.0;
    best.evidence.contradicted = contradicted;
    best.evidence.refuted = refuted;
    const Assessed rival = good(0, {5, 0, 0}, 0.5);
    return judge(compared(best, rival, contrast), entries(1, 0.05), kZero, {});
  };
  EXPECT_EQ(verdict(0.0, 0.0, 0.2F).status, QueryStatus::kLocalized);
  EXPECT_EQ(verdict(0.01, 0.001, 0.2F).status, QueryStatus::kLocalized) << "as right ones have";
  EXPECT_EQ(verdict(0.3, 0.0, 0.2F).status, QueryStatus::kNotFound);
  EXPECT_EQ(verdict(0.0, 0.1, 0.2F).status, QueryStatus::kNotFound);
  EXPECT_EQ(verdict(0.0, 0.0, -0.9F).status, QueryStatus::kNotFound);
}

TEST(Judge, CallsTheSamePoseInAnotherEntryARival) {
  const Verdict verdict =
      judge({good(0, kZero, 0.8), good(1, kZero, 0.8)}, entries(2, 0.05), kZero, {});
  EXPECT_EQ(verdict.status, QueryStatus::kAmbiguous);
  ASSERT_EQ(verdict.judged.size(), 2U);
  EXPECT_EQ(verdict.judged[0].pose.entry, 0U);
  EXPECT_EQ(verdict.judged[1].pose.entry, 1U);
}

TEST(Judge, TakesTheSamePoseTwiceForNoRival) {
  Assessed turned_a_little = good(0, {0.3, 0, 0}, 0.79);
  turned_a_little.T_entry_sensor.linear() = rotation_from_vector({0, 0, 0.1});
  const Verdict verdict = judge(
      {good(0, kZero, 0.8), good(0, kZero, 0.8), turned_a_little}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(verdict.status, QueryStatus::kLocalized);
  EXPECT_EQ(verdict.judged.size(), 1U);
}

TEST(Judge, KeepsTheCloserOfTwoPosesOfOneSpotThatScoreAlike) {
  Assessed slid = good(0, {0.15, 0, 0}, 0.8);
  slid.closeness = 0.5;
  Assessed close = good(0, kZero, 0.78);
  close.closeness = 0.6;
  const auto kept = [&] { return judge({slid, close}, entries(1, 0.05), kZero, {}).judged; };
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_EQ(kept()[0].pose.score, 0.78);
  close.closeness = 0.4;
  EXPECT_EQ(kept()[0].pose.score, 0.8);
  close.closeness = 0.6;
  close.score = 0.6;  // it explains far less
  EXPECT_EQ(kept()[0].pose.score, 0.8);
}

TEST(Judge, CallsATurnOnTheSpotARival) {
  Assessed turned = good(0, kZero, 0.79);
  turned.T_entry_sensor.linear() = rotation_from_vector({0, 0, 3.14});
  EXPECT_EQ(judge({good(0, kZero, 0.8), turned}, entries(1, 0.05), kZero, {}).status,
            QueryStatus::kAmbiguous);
}

TEST(Judge, ComparesPosesWhereTheCloudIsNotAtTheSensor) {
  // 0.1 rad is no other pose as a turn, but carries a cloud 20 m off by 2 m.
  Assessed turned = good(0, kZero, 0.79);
  turned.T_entry_sensor.linear() = rotation_from_vector({0, 0, 0.1});
  EXPECT_EQ(judge({good(0, kZero, 0.8), turned}, entries(1, 0.05), {20, 0, 0}, {}).status,
            QueryStatus::kAmbiguous);
  EXPECT_EQ(judge({good(0, kZero, 0.8), turned}, entries(1, 0.05), kZero, {}).status,
            QueryStatus::kLocalized);
}

TEST(Judge, MeasuresDistanceInTheEntrysCellsUpToHalfAMetre) {
  // 0.3 m apart: another place on a table top at 2 cm, the same in a room at 5 cm.
  std::vector<Assessed> poses{good(0, kZero, 0.8), good(0, {0.3, 0, 0}, 0.79)};
  EXPECT_EQ(judge(poses, entries(1, 0.02), kZero, {}).status, QueryStatus::kAmbiguous);
  EXPECT_EQ(judge(poses, entries(1, 0.05), kZero, {}).status, QueryStatus::kLocalized);
  poses[1].T_entry_sensor.translation().x() = 1.0;
  EXPECT_EQ(judge(poses, entries(1, 0.20), kZero, {}).status, QueryStatus::kAmbiguous);
}

TEST(Judge, TellsTheLeadOverTheBestRival) {
  const Verdict verdict =
      judge({good(0, kZero, 0.8), good(0, {5, 0, 0}, 0.7), good(0, {9, 0, 0}, 0.6)},
            entries(1, 0.05),
            kZero,
            {});
  ASSERT_EQ(verdict.judged.size(), 3U);
  EXPECT_NEAR(verdict.judged[0].margin, 1.0 - 0.7 / 0.8, 1e-12);
  EXPECT_EQ(verdict.judged[1].margin, 0.0);
  EXPECT_EQ(verdict.judged[2].margin, 0.0);
}

TEST(Judge, TakesTwoObjectsThatStandApartForNoRivals) {
  std::vector<Entry> objects = entries(2, 0.05, EntryKind::kObject);
  // Object coordinates: the sensor 5 m off to either side is an object 5 m off to either side.
  const Verdict apart =
      judge({good(0, {5, 0, 0}, 0.8), good(0, {-5, 0, 0}, 0.79), good(1, {0, 5, 0}, 0.79)},
            objects,
            kZero,
            {});
  EXPECT_EQ(apart.status, QueryStatus::kLocalized);
  EXPECT_EQ(apart.judged.size(), 3U);
}

TEST(Judge, CallsTwoObjectsAtOneSpotAmbiguous) {
  const std::vector<Entry> objects = entries(2, 0.05, EntryKind::kObject);
  EXPECT_EQ(judge({good(0, {5, 0, 0}, 0.8), good(1, {5, 0, 0}, 0.79)}, objects, kZero, {}).status,
            QueryStatus::kAmbiguous);
  // One object, turned about its own centre.
  Assessed turned = good(0, kZero, 0.79);
  const Eigen::Vector3d centre = objects[0].centre;
  turned.T_entry_sensor.linear() = rotation_from_vector({0, 0, 3.0});
  turned.T_entry_sensor.translation() =
      centre + turned.T_entry_sensor.linear() * (Eigen::Vector3d(5, 0, 0) - centre);
  EXPECT_EQ(judge({good(0, {5, 0, 0}, 0.8), turned}, objects, kZero, {}).status,
            QueryStatus::kAmbiguous);
}

TEST(Judge, TakesAnObjectInAPlaceForNoRivalOfThePlace) {
  std::vector<Entry> both = entries(1, 0.05);
  both.push_back(std::move(entries(1, 0.05, EntryKind::kObject)[0]));
  EXPECT_EQ(judge({good(0, kZero, 0.8), good(1, kZero, 0.79)}, both, kZero, {}).status,
            QueryStatus::kLocalized);
}

TEST(Judge, IsNotMovedByARivalFarBehind) {
  EXPECT_EQ(
      judge({good(0, kZero, 0.8), good(0, {5, 0, 0}, 0.3)}, entries(1, 0.05), kZero, {}).status,
      QueryStatus::kLocalized);
}

TEST(Judge, FindsNothingWhenTheBestIsPoorAndSaysWhy) {
  const Verdict verdict = judge({poor(0, kZero, 0.3)}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(verdict.status, QueryStatus::kNotFound);
  EXPECT_THAT(verdict.reason, HasSubstr("verify"));
  EXPECT_THAT(verdict.reason, HasSubstr("30 %"));
  EXPECT_THAT(verdict.reason, HasSubstr("50 %"));
  ASSERT_EQ(verdict.judged.size(), 1U);
  EXPECT_LT(verdict.judged[0].confidence, 0.5);
}

TEST(Judge, DoesNotCallTwoPoorPosesAmbiguous) {
  EXPECT_EQ(
      judge({poor(0, kZero, 0.3), poor(0, {5, 0, 0}, 0.3)}, entries(1, 0.05), kZero, {}).status,
      QueryStatus::kNotFound);
}

TEST(Judge, FindsNothingWithoutPoses) {
  const Verdict none = judge({}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(none.status, QueryStatus::kNotFound);
  EXPECT_THAT(none.reason, HasSubstr("pose"));
  EXPECT_TRUE(none.judged.empty());
  const Verdict zero = judge({good(0, kZero, 0.0)}, entries(1, 0.05), kZero, {});
  EXPECT_EQ(zero.status, QueryStatus::kNotFound);
  EXPECT_NE(zero.reason, "");
}

TEST(Judge, FollowsTheConfidenceAsked) {
  const std::vector<Assessed> poses{good(0, kZero, 0.6)};
  const double confidence = judge(poses, entries(1, 0.05), kZero, {}).judged[0].confidence;
  VerdictOptions options;
  options.min_confidence = confidence + 1e-6;
  EXPECT_EQ(judge(poses, entries(1, 0.05), kZero, options).status, QueryStatus::kNotFound);
  options.min_confidence = confidence - 1e-6;
  EXPECT_EQ(judge(poses, entries(1, 0.05), kZero, options).status, QueryStatus::kLocalized);
}

TEST(Judge, DoesNotDependOnTheOrderOfThePoses) {
  std::vector<Assessed> poses{
      good(1, kZero, 0.8), poor(0, {5, 0, 0}, 0.2), good(0, {-4, 0, 0}, 0.75)};
  const Verdict forth = judge(poses, entries(2, 0.05), kZero, {});
  std::reverse(poses.begin(), poses.end());
  const Verdict back = judge(poses, entries(2, 0.05), kZero, {});
  EXPECT_EQ(forth.status, back.status);
  ASSERT_EQ(forth.judged.size(), back.judged.size());
  for (std::size_t i = 0; i < forth.judged.size(); ++i) {
    EXPECT_EQ(forth.judged[i].pose.score, back.judged[i].pose.score);
    EXPECT_EQ(forth.judged[i].confidence, back.judged[i].confidence);
  }
}

}  // namespace
}  // namespace landmarkdb
