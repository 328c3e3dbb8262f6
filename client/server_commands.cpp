#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "client/program.hpp"
#include "client/render_server.hpp"
#include "client/session.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

int run_stats(const Program& program) {
  Session session(program.options);
  const Stats stats = session.connect().stats(session.context());
  session.finish();
  program.print(stats_json(stats), stats_text(stats));
  return 0;
}

// Ends with 8 while queries are not answered, so that a script can wait for readiness.
int run_health(const Program& program) {
  Session session(program.options);
  const Health health = session.connect().health(session.context());
  session.finish();
  program.print(health_json(health), health_text(health));
  return health.ready ? 0 : exit_status(ErrorCode::kUnavailable);
}

int run_reload(const Program& program) {
  Session session(program.options);
  const Reload reload = session.connect().reload(session.context());
  session.finish();
  program.print(reload_json(reload), reload_text(reload));
  return 0;
}

void add(CLI::App& app,
         Program& program,
         const std::string& name,
         const std::string& description,
         int (*run)(const Program&)) {
  CLI::App* command = cli::add_command(app, name, description, {{"landmarkdb " + name, ""}});
  command->callback([&program, run] { program.action = [&program, run] { return run(program); }; });
}

}  // namespace

void add_server_commands(CLI::App& app, Program& program) {
  add(app, program, "stats", "Print the server's figures", run_stats);
  add(app, program, "health", "Print the server's state; 0 when it answers queries", run_health);
  add(app, program, "reload", "Make the server read its database again", run_reload);
}

}  // namespace landmarkdb::client
