#include <algorithm>
#include <thread>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "cli/help.hpp"
#include "cli/main_guard.hpp"
#include "datasets/generate/commands.hpp"

namespace landmarkdb::datasets {

int Generator::thread_count() const {
  if (threads > 0) return threads;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace landmarkdb::datasets

int main(int argc, char** argv) {
  using namespace landmarkdb;
  CLI::App app;
  datasets::Generator generator;
  cli::set_up_program(
      app,
      "landmarkdb-generate",
      "Make places with laser scans of them and queries whose true poses are known",
      {{"landmarkdb-generate place --type lobby --seed 1 --out lobby", "one place, 10 queries"},
       {"landmarkdb-generate many --count 200 --seed 1000 --out many", "many small places"},
       {"landmarkdb-generate list", "the types of place there are"}});
  app.add_flag("--json", generator.json, "Print results, and errors, as JSON");
  app.add_flag("--quiet", generator.quiet, "No progress on standard error");
  app.add_option("--threads", generator.threads, "How many threads to compute with (one a core)")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  app.require_subcommand(1);
  datasets::add_place_command(app, generator);
  datasets::add_many_command(app, generator);
  datasets::add_list_command(app, generator);
  datasets::add_picture_command(app, generator);
  return cli::run_main(argc, argv, app, [&] { return generator.action(); });
}
