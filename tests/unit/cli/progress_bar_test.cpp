#include "cli/progress_bar.hpp"

#include <chrono>
#include <cstdlib>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landmarkdb::cli {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

// A bar whose clock stands still until told.
struct Fixture {
  explicit Fixture(ProgressStyle style) : bar(style, out, [this] { return now; }) {}
  ProgressBar::Clock::time_point now{1000s};
  std::ostringstream out;
  ProgressBar bar;
};

TEST(ProgressFigures, GivesShareRateAndTimeLeft) {
  EXPECT_EQ(progress_figures({"describe", 500, 1000}, 0, 5s), "50 %, 100 /s, 0:05 left");
}

TEST(ProgressFigures, CountsTheRateFromWhereTheStageBegan) {
  EXPECT_EQ(progress_figures({"store", 3'000'000, 4'000'000}, 1'000'000, 1s),
            "75 %, 2.0 M/s, 0:01 left");
}

TEST(ProgressFigures, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(progress_figures({"read", 0, 10}, 0, 0s), "0 %");
  EXPECT_EQ(progress_figures({"read", 2000, 0}, 0, 1s), "2.0 k/s");
  EXPECT_EQ(progress_figures({"read", 0, 0}, 0, 0s), "");
}

TEST(ProgressFigures, NeverGoesPastTheEnd) {
  EXPECT_EQ(progress_figures({"read", 30, 10}, 0, 10s), "100 %, 1 /s");
}

TEST(ProgressFigures, SaysHoursForLongJobs) {
  EXPECT_THAT(progress_figures({"describe", 1, 7201}, 0, 1s), HasSubstr("2:00:00 left"));
}

TEST(ProgressBar, IsSilentWhenQuiet) {
  Fixture fixture(ProgressStyle::kNone);
  fixture.bar.update({"read", 1, 2});
  fixture.now += 60s;
  fixture.bar.update({"read", 2, 2});
  fixture.bar.finish();
  EXPECT_EQ(fixture.out.str(), "");
}

TEST(ProgressBar, WritesAPlainLineEveryTenSeconds) {
  Fixture fixture(ProgressStyle::kLines);
  fixture.bar.update({"describe", 0, 100});
  for (int second = 1; second <= 25; ++second) {
    fixture.now += 1s;
    fixture.bar.update({"describe", static_cast<std::uint64_t>(second), 100});
  }
  fixture.bar.finish();
  EXPECT_EQ(fixture.out.str(),
            "describe: 10 %, 1 /s, 1:30 left\n"
            "describe: 20 %, 1 /s, 1:20 left\n");
}

TEST(ProgressBar, RedrawsOneLineAndTakesItAway) {
  Fixture fixture(ProgressStyle::kBar);
  fixture.bar.update({"describe", 0, 100});
  fixture.bar.update({"describe", 1, 100});  // too soon to be drawn
  fixture.now += 1s;
  fixture.bar.update({"describe", 50, 100});
  fixture.bar.finish();
  const std::string text = fixture.out.str();
  EXPECT_THAT(text, Not(HasSubstr("\n")));
  EXPECT_THAT(text, Not(HasSubstr("1 %")));
  EXPECT_THAT(text, HasSubstr("[###############...............]"));
  EXPECT_THAT(text, HasSubstr("50 %, 50 /s, 0:01 left"));
  EXPECT_TRUE(text.ends_with("\r\033[K"));
}

TEST(ProgressBar, DrawsANewStageAtOnce) {
  Fixture fixture(ProgressStyle::kBar);
  fixture.bar.update({"read", 1, 1});
  fixture.bar.update({"describe", 0, 10});
  EXPECT_THAT(fixture.out.str(), HasSubstr("describe"));
}

TEST(ProgressBar, LetsNoStageNameSteerTheTerminal) {
  std::ostringstream out;
  ProgressBar bar(ProgressStyle::kBar, out);
  bar.update({"\033[2Jmatch", 1, 2});
  EXPECT_EQ(out.str().find("\033[2J"), std::string::npos);
  EXPECT_NE(out.str().find("?[2Jmatch"), std::string::npos);
}

TEST(ColourWanted, RespectsNoColor) {
  ::setenv("NO_COLOR", "1", 1);
  EXPECT_FALSE(colour_wanted());
  ::unsetenv("NO_COLOR");
}

}  // namespace
}  // namespace landmarkdb::cli
