#include "cli/option_tables.hpp"

#include <algorithm>
#include <sstream>

namespace landmarkdb::cli {
namespace {

// CLI11 writes the values of an option that takes one of a few into the type's name, "TEXT:{a,b}".
std::vector<std::string> choices_in(const std::string& type) {
  const auto open = type.find('{');
  const auto close = type.find('}', open);
  std::vector<std::string> choices;
  if (open == std::string::npos || close == std::string::npos) return choices;
  std::istringstream list(type.substr(open + 1, close - open - 1));
  for (std::string choice; std::getline(list, choice, ',');) choices.push_back(choice);
  return choices;
}

OptionRow row_of(const CLI::Option& option) {
  OptionRow row;
  if (option.nonpositional()) {
    for (const std::string& name : option.get_snames()) row.names.push_back('-' + name);
    for (const std::string& name : option.get_lnames()) row.names.push_back("--" + name);
  } else {
    row.names.push_back(option.get_name(true));
  }
  const std::string type = option.get_type_name();
  const bool flag = option.nonpositional() && option.get_items_expected_max() == 0;
  if (!flag) {
    row.choices = choices_in(type);
    // What follows a colon is how CLI11 describes the checks on the value.
    row.value = row.choices.empty() ? type.substr(0, type.find(':')) : "VALUE";
    if (row.value.empty()) row.value = "VALUE";
  }
  row.description = option.get_description();
  row.required = option.get_required();
  row.repeated = option.get_expected_max() > 1;
  return row;
}

std::vector<const CLI::App*> shown_subcommands(const CLI::App& app) {
  auto subcommands = app.get_subcommands(
      [](const CLI::App* sub) { return !sub->get_group().empty() && !sub->get_name().empty(); });
  // Every program's first subcommand, but the last that anyone looks for.
  std::stable_partition(subcommands.begin(), subcommands.end(), [](const CLI::App* sub) {
    return sub->get_name() != "completion";
  });
  return subcommands;
}

void append_rows(const CLI::App& app, std::vector<CommandRow>& rows) {
  rows.push_back(command_row(app));
  for (const CLI::App* sub : shown_subcommands(app)) append_rows(*sub, rows);
}

}  // namespace

std::string CommandRow::path_text() const {
  std::string text;
  for (const std::string& name : path) text += (text.empty() ? "" : " ") + name;
  return text;
}

CommandRow command_row(const CLI::App& app) {
  CommandRow row;
  for (const CLI::App* at = &app; at->get_parent() != nullptr; at = at->get_parent()) {
    row.path.insert(row.path.begin(), at->get_name());
  }
  row.description = app.get_description();
  row.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    (option->nonpositional() ? row.options : row.positionals).push_back(row_of(*option));
  }
  for (const CLI::App* sub : shown_subcommands(app)) {
    row.subcommands.emplace_back(sub->get_name(), sub->get_description());
  }
  return row;
}

std::string OptionRow::value_text() const {
  if (choices.empty()) return value;
  std::string text;
  for (const std::string& choice : choices) text += (text.empty() ? "" : "|") + choice;
  return text;
}

std::vector<CommandRow> command_rows(const CLI::App& app) {
  std::vector<CommandRow> rows;
  append_rows(app, rows);
  return rows;
}

}  // namespace landmarkdb::cli
