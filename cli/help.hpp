#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

// A command line as one would type it, and what it does.
struct Example {
  std::string command;
  std::string effect;
};

// Sets up a program: its name and description, --help with the examples, --version, and the two
// subcommands every program has, `completion SHELL` and the hidden `man`. Call add_command for its
// subcommands afterwards. Options of the program may be given after the subcommand too.
void set_up_program(CLI::App& app,
                    const std::string& name,
                    const std::string& description,
                    const std::vector<Example>& examples);

// Adds a subcommand with its own --help (with the examples) and --version.
CLI::App* add_command(CLI::App& parent,
                      const std::string& name,
                      const std::string& description,
                      const std::vector<Example>& examples);

// Adds an option that may be given several times, one value each time: `--pose A --pose B`. A
// following argument is never taken for a second value.
CLI::Option* add_repeated(CLI::App& app,
                          const std::string& names,
                          std::vector<std::string>& values,
                          const std::string& description);

// The program an app belongs to: itself, or the topmost parent.
const CLI::App& program_of(const CLI::App& app);

}  // namespace landmarkdb::cli
