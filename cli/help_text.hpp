#pragma once

#include <string>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

// What --help prints for a program or subcommand: usage, what it does, arguments, options (those of
// the program too), subcommands, examples. Lines are at most 100 columns wide, as far as words
// allow.
std::string help_text(const CLI::App& app);

}  // namespace landmarkdb::cli
