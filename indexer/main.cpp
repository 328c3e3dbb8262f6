#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "cli/help.hpp"
#include "cli/main_guard.hpp"
#include "indexer/commands.hpp"

int main(int argc, char** argv) {
  using namespace landmarkdb;
  CLI::App app;
  indexer::Program program;
  cli::set_up_program(
      app,
      "landmarkdb-indexer",
      "Turn 3D scans and models into a database of places and objects, and keep it",
      {{"landmarkdb-indexer --db site.db add lobby lobby.ply", "describe a scan and store it"},
       {"landmarkdb-indexer --db site.db list", "what is in the database"},
       {"landmarkdb-indexer add --help", "all about one command"}});
  app.add_option("--db", program.db, "The database file")->type_name("FILE");
  app.add_flag("--json", program.json, "Print results, and errors, as JSON");
  app.add_flag("--quiet", program.quiet, "No progress and no remarks on standard error");
  app.add_option("--threads", program.threads, "How many threads to compute with (one a core)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  app.require_subcommand(1);
  indexer::add_add_command(app, program);
  indexer::add_scene_commands(app, program);
  indexer::add_landmark_commands(app, program);
  indexer::add_model_commands(app, program);
  indexer::add_upkeep_commands(app, program);
  indexer::add_transfer_commands(app, program);
  return cli::run_main(argc, argv, app, [&] { return program.action(); });
}
