#include "cli/man_page.hpp"

#include <algorithm>
#include <array>
#include <sstream>
#include <utility>
#include <vector>

#include "cli/help.hpp"
#include "cli/option_tables.hpp"
#include "cli/version.hpp"

namespace landmarkdb::cli {
namespace {

constexpr std::array<std::pair<int, const char*>, 10> kExitStatuses = {{
    {0, "done"},
    {1, "internal error"},
    {2, "wrong usage"},
    {3, "it ran and nothing was found"},
    {4, "ambiguous"},
    {5, "database damaged"},
    {6, "version refused"},
    {7, "bad input file"},
    {8, "unavailable or past the deadline"},
    {9, "not permitted"},
}};
constexpr int kInterrupted = 130;

// Text as roff shows it verbatim: backslashes and hyphens escaped, no line mistaken for a request.
std::string roff(const std::string& text) {
  std::string out;
  bool line_start = true;
  for (const char c : text) {
    if (line_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    line_start = c == '\n';
  }
  return out;
}

void append_option(const OptionRow& option, std::string& page) {
  page += ".TP\n";
  std::string names;
  for (const std::string& name : option.names) {
    names += (names.empty() ? "" : ", ") + ("\\fB" + roff(name) + "\\fR");
  }
  page += names;
  if (option.takes_value()) page += " \\fI" + roff(option.value_text()) + "\\fR";
  page += "\n" + roff(option.description);
  if (option.repeated) page += "; may be given several times";
  page += "\n";
}

void append_positional(const OptionRow& option, std::string& page) {
  page += ".TP\n\\fI" + roff(option.names.front()) + "\\fR";
  if (!option.choices.empty()) page += " (" + roff(option.value_text()) + ")";
  page += "\n" + roff(option.description);
  if (option.repeated) page += "; may be given several times";
  page += "\n";
}

void append_command(const std::string& program, const CommandRow& row, std::string& page) {
  std::string line = program + ' ' + row.path_text();
  for (const OptionRow& option : row.positionals) {
    const std::string name = option.names.front() + (option.repeated ? "..." : "");
    line += option.required ? ' ' + name : " [" + name + ']';
  }
  page += ".SS \"" + roff(line) + "\"\n" + roff(row.description) + "\n";
  for (const OptionRow& option : row.positionals) append_positional(option, page);
  for (const OptionRow& option : row.options) append_option(option, page);
  if (!row.footer.empty()) page += ".PP\n.nf\n" + roff(row.footer) + "\n.fi\n";
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  return text;
}

}  // namespace

std::string man_page(const CLI::App& app) {
  const std::string& name = app.get_name();
  const std::vector<CommandRow> rows = command_rows(app);
  const CommandRow& program = rows.front();
  std::string page = ".TH " + upper(name) + " 1 \"\" \"landmarkdb " +
                     std::string(program_version()) + "\"\n.SH NAME\n" + roff(name) + " \\- " +
                     roff(program.description) + "\n.SH SYNOPSIS\n\\fB" + roff(name) +
                     "\\fR [\\fIOPTION\\fR]...";
  if (!program.subcommands.empty()) page += " [\\fICOMMAND\\fR] [\\fIARGUMENT\\fR]...";
  page += "\n.SH OPTIONS\n";
  for (const OptionRow& option : program.positionals) append_positional(option, page);
  for (const OptionRow& option : program.options) append_option(option, page);
  if (rows.size() > 1) page += ".SH COMMANDS\n";
  for (std::size_t i = 1; i < rows.size(); ++i) append_command(name, rows[i], page);
  if (!program.footer.empty()) {
    page += ".SH EXAMPLES\n.nf\n" + roff(program.footer) + "\n.fi\n";
  }
  page += ".SH EXIT STATUS\n";
  for (const auto& [status, meaning] : kExitStatuses) {
    page += ".TP\n" + std::to_string(status) + "\n" + roff(meaning) + "\n";
  }
  return page + ".TP\n" + std::to_string(kInterrupted) + "\ninterrupted\n";
}

void add_man_command(CLI::App& app) {
  CLI::App* command = add_command(app, "man", "Print the manual page", {});
  command->group("");  // hidden: for packagers
  command->parse_complete_callback([&app] { throw CLI::CallForVersion(man_page(app), 0); });
}

}  // namespace landmarkdb::cli
