#include "cli/completion.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/unit/cli/sample_app.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

// What bash offers once `words` are typed, the last of them under the cursor.
std::set<std::string> bash_offers(const std::string& words) {
  const testing::SampleApp sample;
  const auto path = std::filesystem::temp_directory_path() /
                    ("landmarkdb_completion_" + std::to_string(::getpid()) + ".bash");
  std::ofstream(path) << completion_script(sample.app, Shell::kBash)
                      << "\ncd /\nCOMP_WORDS=(sample-prog " << words
                      << ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_sample_prog\n"
                         "printf '%s\\n' \"${COMPREPLY[@]}\"\n";
  std::set<std::string> offers;
  FILE* pipe = ::popen(("bash --norc " + path.string()).c_str(), "r");
  std::array<char, 4096> line{};
  while (pipe != nullptr && std::fgets(line.data(), line.size(), pipe) != nullptr) {
    std::string word = line.data();
    word.erase(word.find_last_not_of('\n') + 1);
    if (!word.empty()) offers.insert(word);
  }
  EXPECT_EQ(::pclose(pipe), 0);
  std::filesystem::remove(path);
  return offers;
}

TEST(BashCompletion, OffersSubcommandsAndProgramOptions) {
  const auto offers = bash_offers("''");
  EXPECT_THAT(offers, Contains("go"));
  EXPECT_THAT(offers, Contains("mark"));
  EXPECT_THAT(offers, Contains("--db"));
  EXPECT_THAT(offers, Not(Contains("man")));
}

TEST(BashCompletion, OffersASubcommandsOptions) {
  EXPECT_THAT(bash_offers("go --"),
              UnorderedElementsAre("--help", "--version", "--method", "--pose", "--fast", "--db"));
}

TEST(BashCompletion, FollowsNestedSubcommands) {
  const auto offers = bash_offers("mark ''");
  EXPECT_THAT(offers, Contains("add"));
  EXPECT_THAT(offers, Contains("remove"));
  EXPECT_THAT(bash_offers("mark add --sh"), UnorderedElementsAre("--shape"));
}

TEST(BashCompletion, OffersTheValuesOfAChoice) {
  EXPECT_THAT(bash_offers("go --method ''"), UnorderedElementsAre("walk", "swim"));
  EXPECT_THAT(bash_offers("mark add --shape f"), UnorderedElementsAre("flat"));
  EXPECT_THAT(bash_offers("completion f"), Contains("fish"));
}

TEST(BashCompletion, TakesNoValueForASubcommand) {
  EXPECT_THAT(bash_offers("--db mark --he"), UnorderedElementsAre("--help"));
  EXPECT_THAT(bash_offers("--db mark --me"), UnorderedElementsAre());
  EXPECT_THAT(bash_offers("--db mark go --me"), UnorderedElementsAre("--method"));
}

TEST(ZshCompletion, HoldsEveryCommandAndOption) {
  const testing::SampleApp sample;
  const std::string script = completion_script(sample.app, Shell::kZsh);
  EXPECT_TRUE(script.starts_with("#compdef sample-prog\n"));
  for (const char* text :
       {"'--method:How'", "'mark:Marks'", "values=(round flat)", "'mark add')"}) {
    EXPECT_THAT(script, HasSubstr(text));
  }
}

TEST(FishCompletion, HoldsEveryCommandAndOption) {
  const testing::SampleApp sample;
  const std::string script = completion_script(sample.app, Shell::kFish);
  for (const char* text : {"-l method -r -f -a 'walk swim' -d 'How'",
                           "-f -a go -d 'Go there, don\\'t wait'",
                           "-s p -l pose -r",
                           "'mark add'"}) {
    EXPECT_THAT(script, HasSubstr(text));
  }
}

TEST(CompletionCommand, EndsTheProgramWithTheScript) {
  testing::SampleApp sample;
  sample.app.require_subcommand(1);
  sample.app.get_option("--db")->required();
  std::ostringstream out;
  try {
    sample.app.parse("completion bash", false);
    ADD_FAILURE() << "went on";
  } catch (const CLI::ParseError& error) {
    EXPECT_EQ(sample.app.exit(error, out, out), 0);
  }
  EXPECT_THAT(out.str(), HasSubstr("complete -o"));
}

TEST(CompletionCommand, RefusesAnUnknownShell) {
  testing::SampleApp sample;
  EXPECT_THROW(sample.app.parse("completion tcsh", false), CLI::ValidationError);
  EXPECT_THROW(sample.app.parse("completion", false), CLI::RequiredError);
}

}  // namespace
}  // namespace landmarkdb::cli
