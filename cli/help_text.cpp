#include "cli/help_text.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <vector>

#include "cli/help.hpp"
#include "cli/option_tables.hpp"

namespace landmarkdb::cli {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kColumn = 28;  // where the descriptions start

// Appends words, broken into lines; `at` is the column the text stands at, `indent` that of
// further lines.
void append_wrapped(std::string_view words, std::size_t at, std::size_t indent, std::string& text) {
  std::istringstream stream{std::string(words)};
  bool line_start = true;
  for (std::string word; stream >> word;) {
    if (!line_start && at + 1 + word.size() > kWidth) {
      text += '\n' + std::string(indent, ' ');
      at = indent;
      line_start = true;
    }
    if (!line_start) {
      text += ' ';
      ++at;
    }
    text += word;
    at += word.size();
    line_start = false;
  }
  text += '\n';
}

void append_entry(const std::string& term, const std::string& description, std::string& text) {
  const std::string head = "  " + term;
  text += head;
  if (description.empty()) {
    text += '\n';
    return;
  }
  if (head.size() + 2 > kColumn) {
    text += '\n' + std::string(kColumn, ' ');
  } else {
    text += std::string(kColumn - head.size(), ' ');
  }
  append_wrapped(description, kColumn, kColumn, text);
}

std::string term_of(const OptionRow& option) {
  std::string term;
  for (const std::string& name : option.names) term += (term.empty() ? "" : ", ") + name;
  if (option.takes_value()) term += ' ' + option.value_text();
  if (option.repeated) term += " ...";
  return term;
}

void append_options(const std::string& title,
                    const std::vector<OptionRow>& options,
                    std::string& text) {
  if (options.empty()) return;
  text += '\n' + title + ":\n";
  for (const OptionRow& option : options) {
    append_entry(term_of(option), option.description, text);
  }
}

std::string argument_term(const OptionRow& argument) {
  const std::string name = argument.names.front() + (argument.repeated ? "..." : "");
  return argument.required ? name : '[' + name + ']';
}

std::string usage(const std::string& program, const CommandRow& row) {
  std::string line = "Usage: " + program;
  for (const std::string& name : row.path) line += ' ' + name;
  line += " [OPTION]...";
  for (const OptionRow& option : row.options) {
    if (option.required) line += ' ' + option.names.back() + ' ' + option.value_text();
  }
  for (const OptionRow& argument : row.positionals) line += ' ' + argument_term(argument);
  if (!row.subcommands.empty()) line += " COMMAND ...";
  return line + '\n';
}

void append_arguments(const CommandRow& row, std::string& text) {
  if (row.positionals.empty()) return;
  text += "\nArguments:\n";
  for (const OptionRow& argument : row.positionals) {
    std::string description = argument.description;
    if (!argument.choices.empty()) description += ": " + argument.value_text();
    append_entry(argument_term(argument), description, text);
  }
}

}  // namespace

std::string help_text(const CLI::App& app) {
  const CLI::App& program = program_of(app);
  const CommandRow row = command_row(app);
  std::string text = usage(program.get_name(), row) + '\n';
  append_wrapped(row.description, 0, 0, text);
  append_arguments(row, text);
  append_options("Options", row.options, text);
  if (&app != &program) {
    std::vector<OptionRow> shared = command_row(program).options;
    std::erase_if(shared, [&](const OptionRow& option) {
      return std::any_of(row.options.begin(), row.options.end(), [&](const OptionRow& own) {
        return own.names == option.names;
      });
    });
    append_options("Options of every command", shared, text);
  }
  if (!row.subcommands.empty()) {
    text += "\nCommands:\n";
    for (const auto& [name, description] : row.subcommands) append_entry(name, description, text);
  }
  if (!row.footer.empty()) text += '\n' + row.footer + '\n';
  return text;
}

}  // namespace landmarkdb::cli
