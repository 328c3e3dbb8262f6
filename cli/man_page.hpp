#pragma once

#include <string>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

// The program's man page (section 1, roff), made from its option tables: every subcommand with its
// arguments, options and examples, and the exit statuses.
std::string man_page(const CLI::App& app);

// Adds the hidden subcommand `man`, which prints the page and ends the program with 0.
void add_man_command(CLI::App& app);

}  // namespace landmarkdb::cli
