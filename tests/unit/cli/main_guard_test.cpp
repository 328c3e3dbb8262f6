#include "cli/main_guard.hpp"

#include <array>
#include <new>
#include <stdexcept>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::HasSubstr;

struct Outcome {
  int status = 0;
  std::string out;
  std::string err;
};

Outcome run(std::vector<const char*> arguments, const std::function<int()>& body) {
  CLI::App app;
  bool json = false;
  bool fast = false;
  set_up_program(app, "prog", "A program", {});
  app.add_flag("--json", json, "JSON");
  CLI::App* command = add_command(app, "go", "Go", {{"prog go", "goes"}});
  command->add_flag("--fast", fast, "Fast");
  app.require_subcommand(1);
  arguments.insert(arguments.begin(), "/usr/bin/prog");
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  Outcome outcome;
  outcome.status = run_main(static_cast<int>(arguments.size()), arguments.data(), app, body);
  outcome.out = ::testing::internal::GetCapturedStdout();
  outcome.err = ::testing::internal::GetCapturedStderr();
  return outcome;
}

int done() { return 0; }

TEST(RunMain, ReturnsWhatTheBodyReturns) {
  EXPECT_EQ(run({"go"}, done).status, 0);
  EXPECT_EQ(run({"go"}, [] { return 4; }).status, 4);
}

TEST(RunMain, PrintsAnErrorAsOneLineAndMapsItsCode) {
  const Outcome outcome = run({"go"}, []() -> int {
    throw Error(ErrorCode::kDataLoss, "scene 42: descriptors\nare cut off");
  });
  EXPECT_EQ(outcome.status, 5);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "prog: scene 42: descriptors are cut off\n");
}

// A message may hold a name that a server or a file has sent.
TEST(RunMain, LetsNoMessageSteerTheTerminal) {
  const Outcome outcome = run({"go"}, []() -> int {
    throw Error(ErrorCode::kNotFound, "there is no scene '\033]0;mine\007\xC2\x9B'");
  });
  EXPECT_EQ(outcome.err,
            "prog: there is no scene '?]0;mine?"
            "?"
            "?'\n");
}

TEST(RunMain, PrintsAnErrorAsJsonWhenAskedFor) {
  const Outcome outcome = run({"go", "--json"}, []() -> int {
    throw Error(ErrorCode::kNotFound, "no scene \"x\"", "name");
  });
  EXPECT_EQ(outcome.status, 3);
  const auto error = nlohmann::json::parse(outcome.out).at("error");
  EXPECT_EQ(error.at("code"), "NOT_FOUND");
  EXPECT_EQ(error.at("message"), "no scene \"x\"");
  EXPECT_EQ(error.at("field"), "name");
  EXPECT_EQ(error.at("exit_status"), 3);
}

TEST(RunMain, CallsWrongUsageWrongUsage) {
  for (const auto& arguments : std::vector<std::vector<const char*>>{
           {}, {"stop"}, {"go", "--slow"}, {"go", "extra"}, {"--fast"}}) {
    const Outcome outcome = run(arguments, done);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(outcome.err, HasSubstr("--help"));
  }
  const Outcome outcome =
      run({"go"}, []() -> int { throw UsageError("--up", "0,0,0 is no direction"); });
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.err, "prog: --up: 0,0,0 is no direction (see prog go --help)\n");
}

TEST(RunMain, NamesTheCommandThatIsNotThere) {
  EXPECT_THAT(run({"goo", "--fast"}, done).err, HasSubstr("there is no command 'goo'"));
  EXPECT_THAT(run({}, done).err, HasSubstr("subcommand is required"));
}

// Wherever a value is found wrong: a server may have looked at it.
TEST(RunMain, CallsAWrongValueOfAnOptionWrongUsage) {
  const auto fail = []() -> int {
    throw Error(ErrorCode::kInvalidArgument, "fast is no way to go", "options.fast");
  };
  const Outcome given = run({"go", "--fast"}, fail);
  EXPECT_EQ(given.status, 2);
  EXPECT_EQ(given.err, "prog: fast is no way to go (see prog go --help)\n");
  EXPECT_EQ(run({"go"}, fail).status, 7) << "what was not typed is no usage";
  EXPECT_EQ(run({"go", "--fast"},
                []() -> int {
                  throw Error(ErrorCode::kInvalidArgument, "cloud.ply: truncated", "cloud");
                })
                .status,
            7);
}

TEST(RunMain, GivesUsageErrorsAsJsonToo) {
  const Outcome outcome = run({"go", "--slow", "--json"}, done);
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(nlohmann::json::parse(outcome.out).at("error").at("code"), "INVALID_ARGUMENT");
}

TEST(RunMain, SurvivesWhateverIsThrown) {
  EXPECT_EQ(run({"go"}, []() -> int { throw std::bad_alloc(); }).status, 1);
  EXPECT_EQ(run({"go"}, []() -> int { throw std::runtime_error("odd"); }).status, 1);
}

TEST(RunMain, PrintsHelpAndVersionOfProgramAndSubcommand) {
  const Outcome help = run({"--help"}, [] { return 9; });
  EXPECT_EQ(help.status, 0);
  EXPECT_THAT(help.out, HasSubstr("--version"));
  const Outcome sub_help = run({"go", "--help"}, [] { return 9; });
  EXPECT_EQ(sub_help.status, 0);
  EXPECT_THAT(sub_help.out, AllOf(HasSubstr("--fast"), HasSubstr("prog go\n      goes")));
  const Outcome version = run({"go", "--version"}, [] { return 9; });
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, HasSubstr("database version"));
}

TEST(RunMain, PutsNonUtf8NamesIntoJson) {
  const Outcome outcome = run({"go", "--json"}, []() -> int {
    throw Error(ErrorCode::kInvalidArgument, "file \xff: unreadable");
  });
  EXPECT_TRUE(nlohmann::json::accept(outcome.out));
}

TEST(WantsJson, LooksOnlyBeforeTheDoubleDash) {
  const std::array<const char*, 3> yes = {"prog", "list", "--json"};
  EXPECT_TRUE(wants_json(3, yes.data()));
  const std::array<const char*, 3> no = {"prog", "--", "--json"};
  EXPECT_FALSE(wants_json(3, no.data()));
}

}  // namespace
}  // namespace landmarkdb::cli
