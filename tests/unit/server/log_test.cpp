#include "server/log.hpp"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace landmarkdb {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

TEST(Logger, WritesOneLineAnEventWithItsFields) {
  std::ostringstream out;
  Logger log(out, LogLevel::kInfo, false);
  log.write(LogLevel::kInfo,
            "query",
            {{"scene", std::string("lobby")}, {"ms", 1.5}, {"points", std::uint64_t{7}}});
  EXPECT_THAT(out.str(), EndsWith("Z info query scene=lobby ms=1.5 points=7\n"));
}

TEST(Logger, LeavesOutWhatIsBelowItsLevel) {
  std::ostringstream out;
  Logger(out, LogLevel::kWarning, false).write(LogLevel::kInfo, "quiet");
  Logger(out, LogLevel::kOff, false).write(LogLevel::kError, "quiet");
  EXPECT_EQ(out.str(), "");
}

TEST(Logger, LetsNoNameForgeALine) {
  std::ostringstream out;
  Logger log(out, LogLevel::kInfo, false);
  log.write(LogLevel::kInfo, "a\nb", {{"scene", std::string("x\n2024 error fake=\"1\"\x1b[31m")}});
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  EXPECT_THAT(text, HasSubstr(R"(scene="x\n2024 error fake=\"1\"\u001b[31m")"));
}

TEST(Logger, WritesJsonThatParsesWhateverTheBytes) {
  std::ostringstream out;
  Logger log(out, LogLevel::kDebug, true);
  log.write(LogLevel::kError,
            "say \"hi\"",
            {{"scene", std::string("\xff\n")}, {"ms", std::nan("")}, {"n", std::uint64_t{3}}});
  const auto json = nlohmann::json::parse(out.str());
  EXPECT_EQ(json["message"], "say \"hi\"");
  EXPECT_EQ(json["level"], "error");
  EXPECT_EQ(json["n"], 3);
  EXPECT_TRUE(json["ms"].is_null());
}

TEST(LogLevel, IsFoundByItsName) {
  EXPECT_EQ(log_level_from_name("warning"), LogLevel::kWarning);
  EXPECT_EQ(log_level_from_name("loud"), std::nullopt);
  EXPECT_EQ(log_level_name(LogLevel::kOff), "off");
}

TEST(Logger, ThrowsNothingWhenItsLineCannotBeWritten) {
  std::ostringstream text;
  text.exceptions(std::ios::badbit | std::ios::failbit);
  Logger log(text, LogLevel::kInfo, false);
  EXPECT_THROW(text.setstate(std::ios::badbit), std::ios::failure);
  EXPECT_NO_THROW(log.write(LogLevel::kError, "lost"));
}

}  // namespace
}  // namespace landmarkdb
