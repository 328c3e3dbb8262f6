#include "cli/option_tables.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/cli/sample_app.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::ElementsAre;

const OptionRow& option_named(const CommandRow& row, const std::string& name) {
  const auto found = std::find_if(row.options.begin(), row.options.end(), [&](const auto& option) {
    return std::find(option.names.begin(), option.names.end(), name) != option.names.end();
  });
  if (found == row.options.end()) throw std::runtime_error("no option " + name);
  return *found;
}

const CommandRow& command_named(const std::vector<CommandRow>& rows, const std::string& path) {
  const auto found = std::find_if(
      rows.begin(), rows.end(), [&](const auto& row) { return row.path_text() == path; });
  if (found == rows.end()) throw std::runtime_error("no command " + path);
  return *found;
}

TEST(CommandRows, ListParentsBeforeChildrenAndNothingHidden) {
  const testing::SampleApp sample;
  std::vector<std::string> paths;
  for (const CommandRow& row : command_rows(sample.app)) paths.push_back(row.path_text());
  EXPECT_THAT(paths, ElementsAre("", "go", "mark", "mark add", "mark remove", "completion"));
}

TEST(CommandRows, KnowFlagsValuesAndChoices) {
  const testing::SampleApp sample;
  const auto rows = command_rows(sample.app);
  const CommandRow& go = command_named(rows, "go");
  EXPECT_FALSE(option_named(go, "--fast").takes_value());
  EXPECT_THAT(option_named(go, "--method").choices, ElementsAre("walk", "swim"));
  EXPECT_EQ(option_named(go, "--pose").value, "FILE");
  EXPECT_TRUE(option_named(go, "-p").repeated);
  EXPECT_FALSE(option_named(go, "--method").repeated);
  ASSERT_EQ(go.positionals.size(), 1U);
  EXPECT_THAT(go.positionals[0].names, ElementsAre("PLACE"));
  EXPECT_TRUE(go.positionals[0].required);
}

}  // namespace
}  // namespace landmarkdb::cli
