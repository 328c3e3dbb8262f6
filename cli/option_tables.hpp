#pragma once

#include <string>
#include <utility>
#include <vector>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

// One option or positional argument, as completions and man pages need it.
struct OptionRow {
  std::vector<std::string> names;    // "-h", "--help"; a positional's single name, "CLOUD"
  std::string value;                 // "FILE", "x,y,z"; empty for a flag
  std::vector<std::string> choices;  // the values it takes, where it takes one of a few
  std::string description;
  bool required = false;
  bool repeated = false;

  bool takes_value() const { return !value.empty(); }
  // "FILE", or "walk|swim" where it takes one of a few.
  std::string value_text() const;
};

// One command: the program itself, or a subcommand at any depth.
struct CommandRow {
  std::vector<std::string> path;  // {"landmark", "add"}; empty for the program
  std::string description;
  std::string footer;
  std::vector<OptionRow> options;
  std::vector<OptionRow> positionals;
  std::vector<std::pair<std::string, std::string>> subcommands;  // name, description

  std::string path_text() const;  // "landmark add"
};

// One command by itself.
CommandRow command_row(const CLI::App& app);

// The program and all its subcommands that are not hidden, parents before children.
std::vector<CommandRow> command_rows(const CLI::App& app);

}  // namespace landmarkdb::cli
