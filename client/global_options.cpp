#include "client/global_options.hpp"

#include <fstream>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

#include "engine/base/error.hpp"

namespace landmarkdb::client {

void add_global_options(CLI::App& app, GlobalOptions& options) {
  app.add_option("--server", options.server, "Where the server listens: HOST:PORT or unix:PATH")
      ->type_name("ADDRESS")
      ->envname("LANDMARKDB_SERVER")
      ->capture_default_str();
  app.add_option("--token-file", options.token_file, "File whose first line is the access token")
      ->type_name("FILE");
  app.add_option("--timeout", options.timeout_s, "Longest wait for the answer, in seconds")
      ->type_name("S")
      ->check(CLI::Range(0.001, 86'400.0))
      ->capture_default_str();
  app.add_flag("--json", options.json, "Print one JSON object; errors too");
  app.add_flag("--quiet", options.quiet, "Draw no progress on standard error");
}

std::string read_token(const std::string& path) {
  constexpr std::size_t kLongest = 4096;
  std::ifstream file(path);
  std::string line;
  for (char c = 0; line.size() <= kLongest && file.get(c) && c != '\n';) line.push_back(c);
  const char* const blanks = " \t\r";
  const std::size_t first = line.find_first_not_of(blanks);
  if (first == std::string::npos || line.size() > kLongest) {
    throw Error(ErrorCode::kInvalidArgument,
                path + ": token file cannot be read or its first line holds no token",
                "--token-file");
  }
  return line.substr(first, line.find_last_not_of(blanks) - first + 1);
}

}  // namespace landmarkdb::client
