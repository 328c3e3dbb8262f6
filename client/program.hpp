#pragma once

#include <functional>
#include <string>

#include <CLI/App.hpp>
#include <nlohmann/json_fwd.hpp>

#include "client/global_options.hpp"

namespace landmarkdb::client {

// What every command sees of the command line, and what the parser chose to run. Commands hold a
// reference: it lives in main, as long as the parser.
struct Program {
  GlobalOptions options;
  std::function<int()> action;  // what the parsed command asks for; its result ends the program

  // Prints a result: the object with --json, the text otherwise.
  void print(const nlohmann::ordered_json& object, const std::string& text) const;
};

// Each adds its commands to the program; their values live as long as the program's actions.
void add_query_command(CLI::App& app, Program& program);
void add_recognize_command(CLI::App& app, Program& program);
void add_track_command(CLI::App& app, Program& program);
void add_scene_commands(CLI::App& app, Program& program);
void add_model_commands(CLI::App& app, Program& program);
void add_server_commands(CLI::App& app, Program& program);

}  // namespace landmarkdb::client
