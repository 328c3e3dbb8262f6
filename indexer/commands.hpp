#pragma once

#include <CLI/App.hpp>

#include "indexer/program.hpp"

// The subcommands, a file a group. Each adds its parsers to `app` and, once parsed, leaves what is
// to be done in `program.action`; both must outlive the parse.
namespace landmarkdb::indexer {

void add_add_command(CLI::App& app, Program& program);     // add
void add_scene_commands(CLI::App& app, Program& program);  // remove rename list show rollback tag
void add_landmark_commands(CLI::App& app, Program& program);  // landmark add|remove|list
void add_model_commands(CLI::App& app, Program& program);     // model add|remove|rename|list|show
void add_upkeep_commands(CLI::App& app, Program& program);    // check repair migrate optimize
void add_transfer_commands(CLI::App& app, Program& program);  // backup export import

}  // namespace landmarkdb::indexer
