#include "cli/man_page.hpp"

#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/sample_app.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ManPage, HoldsEveryFlagOfEveryCommand) {
  const testing::SampleApp sample;
  const std::string page = man_page(sample.app);
  for (const char* flag : {"\\-\\-help",
                           "\\-\\-version",
                           "\\-\\-db",
                           "\\-\\-method",
                           "\\-p",
                           "\\-\\-pose",
                           "\\-\\-fast",
                           "\\-\\-shape"}) {
    EXPECT_THAT(page, HasSubstr("\\fB" + std::string(flag) + "\\fR")) << flag;
  }
}

TEST(ManPage, HasTheSectionsOneLooksFor) {
  const testing::SampleApp sample;
  const std::string page = man_page(sample.app);
  for (const char* section : {".TH SAMPLE-PROG 1",
                              ".SH NAME",
                              ".SH SYNOPSIS",
                              ".SH OPTIONS",
                              ".SH COMMANDS",
                              ".SH EXAMPLES",
                              ".SH EXIT STATUS"}) {
    EXPECT_THAT(page, HasSubstr(section));
  }
  EXPECT_THAT(page, HasSubstr(".SS \"sample\\-prog mark add\""));
  EXPECT_THAT(page, HasSubstr("interrupted"));
}

TEST(ManPage, LeavesOutWhatIsHidden) {
  const testing::SampleApp sample;
  EXPECT_THAT(man_page(sample.app), Not(HasSubstr("Print the manual page")));
}

TEST(ManPage, TakesNoTextForARequest) {
  CLI::App app;
  set_up_program(app, "p", ".hidden and 'quoted'", {});
  EXPECT_THAT(man_page(app), HasSubstr("\\&.hidden"));
}

TEST(ManCommand, PrintsThePage) {
  testing::SampleApp sample;
  std::ostringstream out;
  try {
    sample.app.parse("man", false);
    ADD_FAILURE() << "went on";
  } catch (const CLI::ParseError& error) {
    EXPECT_EQ(sample.app.exit(error, out, out), 0);
  }
  EXPECT_THAT(out.str(), HasSubstr(".TH SAMPLE-PROG 1"));
}

}  // namespace
}  // namespace landmarkdb::cli
