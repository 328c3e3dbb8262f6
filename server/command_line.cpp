#include "server/command_line.hpp"

#include <cmath>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "server/hello.hpp"

namespace landmarkdb {

namespace {

// A week: whoever asks for more wants none at all.
constexpr double kMaxDeadline_s = 604'800.0;
constexpr int kMaxThreads = 1024;
constexpr std::uint64_t kMostBudgetMib = std::uint64_t{1} << 24U;  // 16 TiB

}  // namespace

void add_server_options(CLI::App& app, CommandLine& line) {
  cli::set_up_program(
      app,
      "landmarkdb-server",
      "Serve a landmarkdb database: answer where a point cloud was taken.",
      {{"landmarkdb-server --db places.db", "for this machine, on 127.0.0.1:7071"},
       {"landmarkdb-server --db places.db --listen none --unix /run/landmarkdb.sock --read-only",
        "for this user only, over a Unix socket, scenes cannot be changed"},
       {"landmarkdb-server --db places.db --listen 0.0.0.0:7071 --token-file token.txt",
        "for other machines that know the token"},
       {"kill -HUP $(pidof landmarkdb-server)", "read the database again"}});
  ServerOptions& o = line.options;
  app.add_option("--db", o.db, "The database file")->required()->type_name("FILE");
  app.add_option("--listen", o.listen, "TCP address; port 0 takes a free one, 'none' is no TCP")
      ->type_name("HOST:PORT")
      ->capture_default_str();
  app.add_option("--unix", o.unix_path, "Listen on a Unix socket, too (permissions 0600)")
      ->type_name("PATH");
  app.add_option("--threads", o.threads, "Threads that compute; 0: one a core")
      ->type_name("N")
      ->check(CLI::Range(0, kMaxThreads));
  app.add_flag("--read-only", o.read_only, "Refuse requests that change scenes");
  app.add_option("--token-file", line.token_file, "Clients must know the first line of this file")
      ->type_name("FILE");
  app.add_flag("--allow-insecure",
               o.allow_insecure,
               "Listen on an address that other machines can reach without a token");
  app.add_option("--max-message", line.max_message_mib, "Longest message taken, MiB")
      ->type_name("MiB")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{kLargestMessageBytes / (1024 * 1024)}))
      ->capture_default_str();
  app.add_option("--max-connections", o.max_connections, "Clients at the same time")
      ->type_name("N")
      ->check(CLI::Range(1, 60'000))
      ->capture_default_str();
  app.add_option("--memory-budget",
                 line.memory_budget_mib,
                 "Of a database too large to be held, the scenes kept in memory, MiB")
      ->type_name("MiB")
      ->check(CLI::Range(std::uint64_t{0}, kMostBudgetMib))
      ->capture_default_str();
  app.add_option("--deadline", line.deadline_s, "Longest time for a query, seconds")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--port-file", o.port_file, "Write the TCP port to this file once it is bound")
      ->type_name("FILE");
  app.add_option("--log-level", line.log_level, "debug, info, warning, error or off")
      ->type_name("LEVEL")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str();
  app.add_flag("--log-json", o.log_json, "Log one JSON object a line");
  app.set_config("--config", "", "Read options from a TOML file: the long names are its keys");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

ServerOptions server_options(const CommandLine& line) {
  ServerOptions options = line.options;
  options.max_message_bytes = static_cast<std::size_t>(line.max_message_mib) * 1024 * 1024;
  options.scene_memory_bytes = static_cast<std::size_t>(line.memory_budget_mib) << 20U;
  if (!(line.deadline_s >= 0.001 && line.deadline_s <= kMaxDeadline_s)) {
    throw cli::UsageError("--deadline", "want seconds, 0.001 to a week");
  }
  options.deadline =
      std::chrono::milliseconds(static_cast<std::int64_t>(std::lround(line.deadline_s * 1000.0)));
  options.log_level = log_level_from_name(line.log_level).value_or(LogLevel::kInfo);
  if (!line.token_file.empty()) options.token = read_token_file(line.token_file);
  return options;
}

}  // namespace landmarkdb
