#include "bench/retrieval/frame_tally.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::bench {
namespace {

using ::testing::HasSubstr;

AskedFrame frame(QueryStatus status, double metres, double milliseconds = 100.0) {
  AskedFrame asked;
  asked.place = "lobby";
  asked.normal_spread = 0.1;
  asked.scanned = 0.9;
  asked.status = status;
  asked.metres = metres;
  asked.degrees = 1.0;
  asked.milliseconds = milliseconds;
  return asked;
}

AskedFrame stranger(QueryStatus status) {
  AskedFrame asked = frame(status, 1e9);
  asked.place.clear();
  return asked;
}

TEST(FrameTally, TellsRightFromWrongFromDeclined) {
  const FrameTally t = tally({frame(QueryStatus::kLocalized, 0.01, 10.0),
                              frame(QueryStatus::kLocalized, 0.03, 20.0),
                              frame(QueryStatus::kLocalized, 3.0, 30.0),
                              frame(QueryStatus::kAmbiguous, 0.02, 40.0),
                              frame(QueryStatus::kNotFound, 1e9, 50.0)});
  EXPECT_EQ(t.asked, 5U);
  EXPECT_EQ(t.first, 3U);  // the ambiguous one's best pose is right too
  EXPECT_EQ(t.right, 2U);
  EXPECT_EQ(t.wrong, 1U);
  EXPECT_EQ(t.ambiguous, 1U);
  EXPECT_EQ(t.not_found, 1U);
  EXPECT_EQ(t.median_m, 0.03);
  EXPECT_EQ(t.median_ms, 30.0);
  EXPECT_EQ(t.p95_ms, 50.0);
}

TEST(FrameTally, TakesAPoseTurnedTooFarForWrong) {
  AskedFrame turned = frame(QueryStatus::kLocalized, 0.01);
  turned.degrees = 5.1;
  EXPECT_TRUE(turned.wrong());
}

TEST(FrameTally, CountsWhateverAStrangerGetsAsWrong) {
  EXPECT_TRUE(stranger(QueryStatus::kLocalized).wrong());
  EXPECT_FALSE(stranger(QueryStatus::kAmbiguous).wrong());
}

TEST(FrameTally, KeepsStrangersAndDullFramesOutOfTheOthersRows) {
  AskedFrame dull = frame(QueryStatus::kNotFound, 1e9);
  dull.normal_spread = 0.01;
  AskedFrame unscanned = frame(QueryStatus::kNotFound, 1e9);
  unscanned.scanned = 0.3;
  const std::vector<TallyRow> rows = tally_rows(
      {frame(QueryStatus::kLocalized, 0.01), dull, unscanned, stranger(QueryStatus::kLocalized)});
  ASSERT_EQ(rows.size(), 5U);  // no frame was asked with gravity
  EXPECT_EQ(rows[0].tally.asked, 3U);
  EXPECT_EQ(rows[1].tally.asked, 2U);
  EXPECT_EQ(rows[2].tally.asked, 1U);
  EXPECT_EQ(rows[3].tally.asked, 1U);
  EXPECT_EQ(rows[3].tally.wrong, 1U);
  EXPECT_EQ(rows[4].tally.asked, 4U);
}

TEST(FrameTally, SaysTheSameInTheTableAndInJson) {
  const std::vector<TallyRow> rows = tally_rows({frame(QueryStatus::kLocalized, 0.01)});
  EXPECT_THAT(tally_table(rows), HasSubstr("localized right 100.0 %"));
  const auto json = nlohmann::json::parse(tally_json(rows, "one place"));
  EXPECT_EQ(json["settings"], "one place");
  EXPECT_EQ(json["rows"][0]["localized_right"], 1);
  EXPECT_EQ(json["rows"][0]["median_m"], 0.01);
}

TEST(FrameTally, OfNoFramesIsZero) {
  const FrameTally t = tally({});
  EXPECT_EQ(t.asked, 0U);
  EXPECT_EQ(t.p95_ms, 0.0);
  EXPECT_THAT(tally_table(tally_rows({})), HasSubstr("every query"));
}

}  // namespace
}  // namespace landmarkdb::bench
