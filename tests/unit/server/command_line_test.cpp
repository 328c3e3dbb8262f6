#include "server/command_line.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::TemporaryFolder;
using namespace std::chrono_literals;

ServerOptions parse(const std::string& arguments) {
  CLI::App app;
  CommandLine line;
  add_server_options(app, line);
  app.parse(arguments);
  return server_options(line);
}

TEST(ServerCommandLine, HasTheDefaultsOfTheManual) {
  const ServerOptions options = parse("--db a.db");
  EXPECT_EQ(options.db, "a.db");
  EXPECT_EQ(options.listen, "127.0.0.1:7071");
  EXPECT_EQ(options.max_message_bytes, kDefaultMaxMessageBytes);
  EXPECT_EQ(options.deadline, 60s);
  EXPECT_FALSE(options.read_only);
  EXPECT_TRUE(options.token.empty());
  EXPECT_EQ(options.log_level, LogLevel::kInfo);
}

TEST(ServerCommandLine, CarriesEveryOption) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("token")) << "sesame\n";
  const ServerOptions options = parse(
      "--db a.db --listen [::1]:9 --unix s.sock --threads 3 --read-only --allow-insecure"
      " --max-message 2 --max-connections 5 --deadline 0.5 --log-level debug --log-json"
      " --port-file p --token-file " +
      folder.file("token"));
  EXPECT_EQ(options.listen, "[::1]:9");
  EXPECT_EQ(options.unix_path, "s.sock");
  EXPECT_EQ(options.threads, 3);
  EXPECT_TRUE(options.read_only);
  EXPECT_TRUE(options.allow_insecure);
  EXPECT_EQ(options.max_message_bytes, 2U * 1024 * 1024);
  EXPECT_EQ(options.max_connections, 5U);
  EXPECT_EQ(options.deadline, 500ms);
  EXPECT_EQ(options.log_level, LogLevel::kDebug);
  EXPECT_TRUE(options.log_json);
  EXPECT_EQ(options.port_file, "p");
  EXPECT_EQ(options.token, "sesame");
}

TEST(ServerCommandLine, ReadsAFileThatTheCommandLineOverrides) {
  const TemporaryFolder folder;
  const std::string path = folder.file("server.toml");
  std::ofstream(path) << "# places\ndb = \"b.db\"\nlisten = \"127.0.0.1:1\"\nthreads = 4\n"
                         "read-only = true\nmax-message = 7\n";
  const ServerOptions options = parse("--config " + path + " --threads 2");
  EXPECT_EQ(options.db, "b.db");
  EXPECT_EQ(options.listen, "127.0.0.1:1");
  EXPECT_EQ(options.threads, 2);
  EXPECT_TRUE(options.read_only);
  EXPECT_EQ(options.max_message_bytes, 7U * 1024 * 1024);
}

TEST(ServerCommandLine, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  std::ofstream(folder.file("bad.toml")) << "db = \"b.db\"\nthreds = 4\n";
  for (const std::string& arguments : {std::string(""),
                                       std::string("--db a.db --threads -1"),
                                       std::string("--db a.db --max-message 0"),
                                       std::string("--db a.db --max-message 4000"),
                                       std::string("--db a.db --max-connections 0"),
                                       std::string("--db a.db --log-level loud"),
                                       std::string("--db a.db --no-such-option"),
                                       "--config " + folder.file("missing.toml"),
                                       "--config " + folder.file("bad.toml")}) {
    EXPECT_THROW(parse(arguments), CLI::ParseError) << arguments;
  }
  EXPECT_THROW(parse("--db a.db --deadline 0"), cli::UsageError);
  EXPECT_THROW(parse("--db a.db --token-file " + folder.file("missing")), Error);
}

}  // namespace
}  // namespace landmarkdb
