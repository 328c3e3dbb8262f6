#include "client/session.hpp"

#include <chrono>
#include <iostream>

#include "cli/version.hpp"

namespace landmarkdb::client {

Session::Session(const GlobalOptions& options)
    : options_(options), bar_(cli::progress_style(options.quiet), std::cerr) {
  context_.stop = interrupt_.token();
  context_.deadline = std::chrono::steady_clock::now() +
                      std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                          std::chrono::duration<double>(options.timeout_s));
  context_.progress = bar_.callback();
}

Client& Session::connect() {
  ConnectOptions options;
  options.server = options_.server;
  options.client = "landmarkdb " + std::string(cli::program_version());
  if (!options_.token_file.empty()) options.token = read_token(options_.token_file);
  return client_.emplace(options, context_);
}

}  // namespace landmarkdb::client
