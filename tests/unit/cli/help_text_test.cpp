#include "cli/help_text.hpp"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/sample_app.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(HelpText, ShowsUsageArgumentsAndOptionsOfACommand) {
  const testing::SampleApp sample;
  const std::string text = help_text(*sample.app.get_subcommand("go"));
  EXPECT_TRUE(
      text.starts_with("Usage: sample-prog go [OPTION]... PLACE\n\nGo there, don't wait\n"));
  EXPECT_THAT(text, HasSubstr("Arguments:\n  PLACE                     Where to\n"));
  EXPECT_THAT(text, HasSubstr("  --method walk|swim        How\n"));
  EXPECT_THAT(text, HasSubstr("  -p, --pose FILE ...       A pose\n"));
  EXPECT_THAT(text, HasSubstr("  --fast                    At once\n"));
}

TEST(HelpText, ShowsTheProgramsOptionsWithEveryCommandOnce) {
  const testing::SampleApp sample;
  const std::string text = help_text(*sample.app.get_subcommand("mark")->get_subcommand("add"));
  EXPECT_THAT(text, HasSubstr("Options of every command:\n  --db FILE"));
  EXPECT_EQ(text.find("--help"), text.rfind("--help"));
}

TEST(HelpText, ListsCommandsButNotTheHidden) {
  const testing::SampleApp sample;
  const std::string text = help_text(sample.app);
  EXPECT_TRUE(text.starts_with("Usage: sample-prog [OPTION]... COMMAND ...\n"));
  EXPECT_THAT(text, HasSubstr("\n  mark                      Marks\n"));
  EXPECT_THAT(text, Not(HasSubstr("\n  man ")));
}

TEST(HelpText, BreaksLongDescriptions) {
  CLI::App app;
  std::string description;
  for (int i = 0; i < 60; ++i) description += "word ";
  set_up_program(app, "p", description, {});
  std::istringstream lines(help_text(app));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

}  // namespace
}  // namespace landmarkdb::cli
