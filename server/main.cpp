#include <iostream>

#include "cli/main_guard.hpp"
#include "server/command_line.hpp"
#include "server/server.hpp"

int main(int argc, char** argv) {
  CLI::App app;
  landmarkdb::CommandLine line;
  landmarkdb::add_server_options(app, line);
  return landmarkdb::cli::run_main(argc, argv, app, [&line] {
    const landmarkdb::ServerOptions options = landmarkdb::server_options(line);
    landmarkdb::Logger log(std::cerr, options.log_level, options.log_json);
    landmarkdb::Server server(options, log);
    server.stop_on_signals();
    server.start();
    // Whatever the log level: scripts wait for this line.
    for (const std::string& address : server.addresses()) {
      std::cerr << "listening on " + address + "\n" << std::flush;
    }
    server.wait();
    return 0;
  });
}
