#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "cli/help.hpp"

namespace landmarkdb::cli::testing {

// A program with a bit of everything: nested subcommands, flags, choices, repeated values.
struct SampleApp {
  CLI::App app;
  std::string name, method, shape = "round";
  std::vector<std::string> poses;
  bool fast = false;

  SampleApp() {
    set_up_program(app, "sample-prog", "Does samples", {{"sample-prog go x", "goes"}});
    app.add_option("--db", name, "The database")->type_name("FILE");
    CLI::App* go = add_command(app, "go", "Go there, don't wait", {{"sample-prog go -n", ""}});
    go->add_option("PLACE", name, "Where to")->type_name("")->required();
    go->add_option("--method", method, "How")->check(CLI::IsMember({"walk", "swim"}));
    add_repeated(*go, "-p,--pose", poses, "A pose")->type_name("FILE");
    go->add_flag("--fast", fast, "At once");
    CLI::App* group = add_command(app, "mark", "Marks", {});
    CLI::App* add = add_command(*group, "add", "Add a mark", {});
    add->add_option("--shape", shape, "Its shape")->check(CLI::IsMember({"round", "flat"}));
    add_command(*group, "remove", "Remove a mark", {});
  }
};

}  // namespace landmarkdb::cli::testing
