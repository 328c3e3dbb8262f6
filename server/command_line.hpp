#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "server/options.hpp"

namespace landmarkdb {

// What the command line and the configuration file say, before it is checked.
struct CommandLine {
  ServerOptions options;
  std::string token_file;
  std::uint64_t max_message_mib = kDefaultMaxMessageBytes / (1024 * 1024);
  std::uint64_t memory_budget_mib = 1024;
  double deadline_s = 60.0;
  std::string log_level = "info";
};

// Sets up the program: its name, help and options, each also a key of the --config file. `line`
// must live as long as `app`.
void add_server_options(CLI::App& app, CommandLine& line);

// The options, after parsing. Reads the token file. Throws cli::UsageError, Error.
ServerOptions server_options(const CommandLine& line);

}  // namespace landmarkdb
