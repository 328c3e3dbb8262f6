#include <CLI/CLI.hpp>

#include "cli/help.hpp"
#include "cli/main_guard.hpp"
#include "client/program.hpp"

int main(int argc, char** argv) {
  using namespace landmarkdb;  // NOLINT(google-build-using-namespace): main of one program
  CLI::App app;
  client::Program program;
  cli::set_up_program(
      app,
      "landmarkdb",
      "Ask a landmarkdb server where a point cloud was taken or which model an image shows, and "
      "manage its scenes and models.",
      {{"landmarkdb query view.ply", "where is this?"},
       {"landmarkdb recognize image.png --camera cam.json", "which model is this, and where?"},
       {"landmarkdb track video/ --camera cam.json --model box", "where is it in every image?"},
       {"landmarkdb --server unix:/run/landmarkdb.sock scene list", "what is stored"}});
  client::add_global_options(app, program.options);
  client::add_query_command(app, program);
  client::add_recognize_command(app, program);
  client::add_track_command(app, program);
  client::add_scene_commands(app, program);
  client::add_model_commands(app, program);
  client::add_server_commands(app, program);
  app.require_subcommand(1);
  return cli::run_main(argc, argv, app, [&program] { return program.action(); });
}
