#include "cli/help.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/sample_app.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(SetUpProgram, ShowsExamplesAndHidesTheManCommand) {
  const testing::SampleApp sample;
  const std::string help = sample.app.help();
  EXPECT_THAT(help, HasSubstr("Examples:\n  sample-prog go x\n      goes"));
  EXPECT_THAT(help, HasSubstr("completion"));
  EXPECT_THAT(help, Not(HasSubstr("manual page")));
}

TEST(AddCommand, TakesTheProgramsOptionsAfterTheSubcommandToo) {
  testing::SampleApp before;
  before.app.parse("--db a.db go there", false);
  testing::SampleApp after;
  after.app.parse("mark add --db a.db", false);
  EXPECT_EQ(after.name, "a.db");
}

TEST(AddRepeated, TakesOneValueEachTime) {
  testing::SampleApp sample;
  sample.app.parse("go --pose a --pose b there", false);
  EXPECT_THAT(sample.poses, ElementsAre("a", "b"));
  EXPECT_EQ(sample.name, "there");
}

TEST(AddRepeated, TakesValuesThatBeginWithAMinus) {
  testing::SampleApp sample;
  sample.app.parse("go --pose -1,2,3 there", false);
  EXPECT_THAT(sample.poses, ElementsAre("-1,2,3"));
}

TEST(ProgramOf, FindsTheTopmostParent) {
  const testing::SampleApp sample;
  EXPECT_EQ(&program_of(*sample.app.get_subcommand("mark")->get_subcommand("add")), &sample.app);
}

}  // namespace
}  // namespace landmarkdb::cli
