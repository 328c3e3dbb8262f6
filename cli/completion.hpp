#pragma once

#include <string>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

enum class Shell { kBash, kZsh, kFish };

// A completion script for the program, made from its option tables: subcommands, options, the
// values of options that take one of a few, file names elsewhere.
std::string completion_script(const CLI::App& app, Shell shell);

// Adds the subcommand `completion bash|zsh|fish`, which prints the script and ends the program with
// 0, whatever else the command line lacks.
void add_completion_command(CLI::App& app);

}  // namespace landmarkdb::cli
