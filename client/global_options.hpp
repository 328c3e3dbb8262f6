#pragma once

#include <string>

#include <CLI/App.hpp>

#include "client/connect_options.hpp"

namespace landmarkdb::client {

// What every command of the program takes.
struct GlobalOptions {
  std::string server = kDefaultServer;
  std::string token_file;
  double timeout_s = 600.0;  // a lost server must not hang a script for ever
  bool json = false;
  bool quiet = false;
};

void add_global_options(CLI::App& app, GlobalOptions& options);

// The first line of the token file, blanks around it dropped. Throws Error{kInvalidArgument} when
// the file cannot be read or its first line is empty.
std::string read_token(const std::string& path);

}  // namespace landmarkdb::client
