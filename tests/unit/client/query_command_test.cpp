#include "client/query_command.hpp"

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

TEST(QueryOptionsFromArguments, AreTheEnginesDefaultsWhereNothingIsTyped) {
  const QueryOptions options = query_options({});
  const QueryOptions defaults;
  EXPECT_EQ(options.profile, defaults.profile);
  EXPECT_EQ(options.top, defaults.top);
  EXPECT_EQ(options.min_confidence, defaults.min_confidence);
  EXPECT_EQ(options.measure, defaults.measure);
  EXPECT_EQ(options.search, defaults.search);
  EXPECT_EQ(options.ratio, defaults.ratio);
  EXPECT_EQ(options.seed, defaults.seed);
  EXPECT_FALSE(options.keypoints);
  EXPECT_FALSE(options.up);
  EXPECT_FALSE(options.prior_T_scene_sensor);
  EXPECT_TRUE(options.filters.empty());
  EXPECT_FALSE(options.want_correspondences);
}

TEST(QueryOptionsFromArguments, ReadAPriorOfSixteenNumbers) {
  QueryArguments arguments;
  arguments.prior = "1,0,0,4, 0,1,0,5, 0,0,1,6, 0,0,0,1";
  arguments.prior_radius = "2.5";
  const QueryOptions options = query_options(arguments);
  ASSERT_TRUE(options.prior_T_scene_sensor);
  EXPECT_EQ(options.prior_T_scene_sensor->translation(), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(options.prior_radius_m, 2.5);
}

TEST(QueryOptionsFromArguments, WantPriorAndRadiusTogether) {
  QueryArguments arguments;
  arguments.prior_radius = "2";
  EXPECT_THROW(query_options(arguments), cli::UsageError);
  arguments.prior = "1,0,0,4, 0,1,0,5, 0,0,1,6, 0,0,0,1";
  arguments.prior_radius.clear();
  EXPECT_THROW(query_options(arguments), cli::UsageError);
}

TEST(QueryOptionsFromArguments, RefuseWhatIsNoNumber) {
  QueryArguments arguments;
  arguments.up = "0,0";
  EXPECT_THROW(query_options(arguments), cli::UsageError);
}

TEST(QueryCloudsFromArguments, WantNoPoseOrOneForEachCloud) {
  QueryArguments arguments;
  arguments.clouds = {"a.ply", "b.ply"};
  arguments.poses = {"a.txt"};
  EXPECT_THROW(load_query(arguments), cli::UsageError);
  arguments.poses.clear();
  arguments.viewpoints = {"0,0,0"};
  EXPECT_THROW(load_query(arguments), cli::UsageError);
}

// The whole parser, as main() sets it up.
class QueryCommandLine : public ::testing::Test {
 protected:
  QueryCommandLine() {
    cli::set_up_program(app_, "landmarkdb", "test", {});
    add_global_options(app_, program_.options);
    add_query_command(app_, program_);
    add_scene_commands(app_, program_);
    add_server_commands(app_, program_);
    app_.require_subcommand(1);
  }
  void parse(std::vector<const char*> words) {
    words.insert(words.begin(), "landmarkdb");
    app_.parse(static_cast<int>(words.size()), words.data());
  }
  CLI::App app_;
  Program program_;
};

TEST_F(QueryCommandLine, TakesOptionsOnEitherSideOfTheCommand) {
  parse({"--json", "query", "view.ply", "--server", "unix:/x", "--up", "-1,0,0", "--seed", "4"});
  EXPECT_TRUE(program_.options.json);
  EXPECT_EQ(program_.options.server, "unix:/x");
  EXPECT_TRUE(program_.action);
}

TEST_F(QueryCommandLine, TakesCloudsAndPosesInAnyOrder) {
  parse({"query", "a.ply", "--pose", "a.txt", "b.ply", "--scene", "lobby", "--pose", "b.txt"});
  const CLI::App* command = app_.get_subcommand("query");
  EXPECT_EQ(command->get_option("CLOUD")->results(), (std::vector<std::string>{"a.ply", "b.ply"}));
  EXPECT_EQ(command->get_option("--pose")->results(), (std::vector<std::string>{"a.txt", "b.txt"}));
}

TEST_F(QueryCommandLine, ChoosesTheNestedCommandThatWasNamed) {
  parse({"scene", "landmark", "add", "lobby", "desk", "--box", "0,0,0,1,1,1"});
  EXPECT_TRUE(program_.action);
}

TEST_F(QueryCommandLine, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(parse({"query", "view.ply", "--profil", "robust"}), CLI::ParseError);
  EXPECT_THROW(parse({"query", "view.ply", "--measure", "cosine"}), CLI::ParseError);
  EXPECT_THROW(parse({"query", "view.ply", "--solver", "guess"}), CLI::ParseError);
  EXPECT_THROW(parse({"query", "view.ply", "--top", "0"}), CLI::ParseError);
  EXPECT_THROW(parse({"query"}), CLI::ParseError);
  EXPECT_THROW(parse({"recognize", "x.png"}), CLI::ParseError);
  EXPECT_THROW(parse({}), CLI::ParseError);
}

TEST_F(QueryCommandLine, ReportsABadCloudBeforeItLooksForAServer) {
  parse({"--server", "unix:/nowhere/x.sock", "query", "/nowhere/view.ply"});
  try {
    program_.action();
    FAIL() << "answered";
  } catch (const Error& error) {
    EXPECT_EQ(exit_status(error.code()), 7);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("/nowhere/view.ply"));
  }
}

}  // namespace
}  // namespace landmarkdb::client
