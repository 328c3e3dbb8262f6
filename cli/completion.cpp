#include "cli/completion.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <vector>

#include "cli/help.hpp"
#include "cli/option_tables.hpp"
#include "cli/usage_error.hpp"

namespace landmarkdb::cli {
namespace {

// "landmarkdb-indexer" -> "landmarkdb_indexer": names of shell functions.
std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

// Single-quoted for bash and zsh.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string quoted_for_fish(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

// All options with a value, of any command, so that a value is never taken for a subcommand.
std::vector<std::string> value_options(const std::vector<CommandRow>& rows) {
  std::set<std::string> names;
  for (const CommandRow& row : rows) {
    for (const OptionRow& option : row.options) {
      if (option.takes_value()) names.insert(option.names.begin(), option.names.end());
    }
  }
  return {names.begin(), names.end()};
}

// The options that may be typed after a command: its own, and those of the program.
std::vector<OptionRow> options_after(const CommandRow& row, const CommandRow& program) {
  std::vector<OptionRow> options = row.options;
  for (const OptionRow& option : program.options) {
    const bool own = std::any_of(options.begin(), options.end(), [&](const OptionRow& other) {
      return other.names == option.names;
    });
    if (!own) options.push_back(option);
  }
  return options;
}

// The lines of a bash or zsh `case` that follow the subcommands typed so far.
std::string path_cases(const std::vector<CommandRow>& rows, const std::string& indent) {
  std::string text;
  const std::vector<std::string> with_value = value_options(rows);
  if (!with_value.empty()) {
    text += indent + "*' '" + joined(with_value, "|*' '") + ") skip=1 ;;\n";
  }
  for (const CommandRow& row : rows) {
    for (const auto& [name, description] : row.subcommands) {
      const std::string parent = row.path_text();
      text += indent + quoted(parent + ' ' + name) +
              ") command=" + quoted(parent.empty() ? name : parent + ' ' + name) + " ;;\n";
    }
  }
  return text;
}

// One line a command and option that takes one of a few values: `for_choices(words)` is what to do.
std::string choice_cases(const std::vector<CommandRow>& rows,
                         const std::function<std::string(const std::string&)>& for_choices) {
  std::string text;
  for (const CommandRow& row : rows) {
    for (const OptionRow& option : options_after(row, rows.front())) {
      for (const std::string& name : option.names) {
        if (option.choices.empty()) continue;
        text += "    " + quoted(row.path_text() + ':' + name) + ") " +
                for_choices(joined(option.choices, " ")) + " ;;\n";
      }
    }
  }
  return text;
}

std::string bash_script(const std::string& program, const std::vector<CommandRow>& rows) {
  const std::string function = '_' + identifier(program);
  std::string text =
      "# bash completion for " + program + "\n" + function +
      "() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  local command='' words='' skip='' i\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    if [[ -n $skip ]]; then skip=''; continue; fi\n"
      "    case \"$command ${COMP_WORDS[i]}\" in\n" +
      path_cases(rows, "      ") +
      "    esac\n"
      "  done\n"
      "  case \"$command:$prev\" in\n" +
      choice_cases(rows,
                   [](const std::string& words) {
                     return "COMPREPLY=($(compgen -W " + quoted(words) + " -- \"$cur\")); return";
                   }) +
      "  esac\n"
      "  if [[ -n $skip ]]; then return; fi\n"
      "  case $command in\n";
  for (const CommandRow& row : rows) {
    std::vector<std::string> words;
    for (const auto& [name, description] : row.subcommands) words.push_back(name);
    for (const OptionRow& option : row.positionals) {
      words.insert(words.end(), option.choices.begin(), option.choices.end());
    }
    for (const OptionRow& option : options_after(row, rows.front())) {
      words.insert(words.end(), option.names.begin(), option.names.end());
    }
    text += "    " + quoted(row.path_text()) + ") words=" + quoted(joined(words, " ")) + " ;;\n";
  }
  return text +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$cur\"))\n"
         "  if [[ -n $command && $cur != -* ]]; then COMPREPLY+=($(compgen -f -- \"$cur\")); fi\n"
         "}\n"
         "complete -o filenames -o default -F " +
         function + ' ' + program + "\n";
}

// "name:description" for zsh's _describe, whose colons part the two.
std::string zsh_entry(const std::string& name, const std::string& description) {
  std::string escaped;
  for (const char c : name) escaped += c == ':' ? std::string("\\:") : std::string(1, c);
  return quoted(escaped + ':' + description);
}

std::string zsh_script(const std::string& program, const std::vector<CommandRow>& rows) {
  const std::string function = '_' + identifier(program);
  std::string text = "#compdef " + program + "\n" + function +
                     "() {\n"
                     "  local command='' skip=''\n"
                     "  local -a commands options values\n"
                     "  integer i\n"
                     "  for ((i = 2; i < CURRENT; i++)); do\n"
                     "    if [[ -n $skip ]]; then skip=''; continue; fi\n"
                     "    case \"$command ${words[i]}\" in\n" +
                     path_cases(rows, "      ") +
                     "    esac\n"
                     "  done\n"
                     "  case \"$command:${words[CURRENT-1]}\" in\n" +
                     choice_cases(rows,
                                  [](const std::string& words) {
                                    return "values=(" + words + "); compadd -a values; return";
                                  }) +
                     "  esac\n"
                     "  if [[ -n $skip ]]; then _files; return; fi\n"
                     "  case $command in\n";
  for (const CommandRow& row : rows) {
    text += "    " + quoted(row.path_text()) + ")\n      commands=(";
    for (const auto& [name, description] : row.subcommands) {
      text += ' ' + zsh_entry(name, description);
    }
    for (const OptionRow& option : row.positionals) {
      for (const std::string& choice : option.choices) text += ' ' + zsh_entry(choice, "");
    }
    text += " )\n      options=(";
    for (const OptionRow& option : options_after(row, rows.front())) {
      for (const std::string& name : option.names) {
        text += ' ' + zsh_entry(name, option.description);
      }
    }
    text += " ) ;;\n";
  }
  return text +
         "  esac\n"
         "  if [[ ${words[CURRENT]} == -* ]]; then _describe -o option options; return; fi\n"
         "  (( ${#commands} )) && _describe command commands\n"
         "  [[ -n $command ]] && _files\n"
         "}\n"
         "compdef " +
         function + ' ' + program + "\n";
}

std::string fish_script(const std::string& program, const std::vector<CommandRow>& rows) {
  const std::string function = "__" + identifier(program) + "_command";
  std::string text = "# fish completion for " + program + "\nfunction " + function +
                     "\n  set -l command\n  set -l skip\n"
                     "  for word in (commandline -opc)[2..-1]\n"
                     "    if test -n \"$skip\"; set skip; continue; end\n"
                     "    switch \"$command $word\"\n";
  const std::vector<std::string> with_value = value_options(rows);
  if (!with_value.empty()) text += "      case '* " + joined(with_value, "' '* ") + "'\n";
  if (!with_value.empty()) text += "        set skip 1\n";
  for (const CommandRow& row : rows) {
    for (const auto& [name, description] : row.subcommands) {
      const std::string parent = row.path_text();
      const std::string path = parent.empty() ? name : parent + ' ' + name;
      text += "      case '" + parent + ' ' + name + "'\n        set command '" + path + "'\n";
    }
  }
  text += "    end\n  end\n  test \"$command\" = \"$argv[1]\"\nend\n";
  for (const CommandRow& row : rows) {
    const std::string line =
        "complete -c " + program + " -n \"" + function + " '" + row.path_text() + "'\"";
    for (const auto& [name, description] : row.subcommands) {
      text += line + " -f -a " + name + " -d " + quoted_for_fish(description) + "\n";
    }
    for (const OptionRow& option : row.positionals) {
      if (option.choices.empty()) continue;
      text += line + " -f -a " + quoted_for_fish(joined(option.choices, " ")) + "\n";
    }
    for (const OptionRow& option : options_after(row, rows.front())) {
      text += line;
      for (const std::string& name : option.names) {
        text += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      }
      if (option.takes_value()) text += " -r";
      if (!option.choices.empty()) {
        text += " -f -a " + quoted_for_fish(joined(option.choices, " "));
      }
      text += " -d " + quoted_for_fish(option.description) + "\n";
    }
  }
  return text;
}

}  // namespace

std::string completion_script(const CLI::App& app, Shell shell) {
  const std::vector<CommandRow> rows = command_rows(app);
  const std::string& program = app.get_name();
  switch (shell) {
    case Shell::kBash:
      return bash_script(program, rows);
    case Shell::kZsh:
      return zsh_script(program, rows);
    case Shell::kFish:
      return fish_script(program, rows);
  }
  return {};
}

void add_completion_command(CLI::App& app) {
  const std::string name = app.get_name();
  CLI::App* command = add_command(
      app,
      "completion",
      "Print a completion script for a shell",
      {{"source <(" + name + " completion bash)", "completes commands and options in this shell"}});
  command->add_option("SHELL", "The shell")
      ->type_name("")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  // Runs once the subcommand is parsed, before the program misses any option it requires.
  command->parse_complete_callback([&app, command] {
    const std::string shell = command->get_option("SHELL")->as<std::string>();
    const Shell kind = shell == "bash" ? Shell::kBash : shell == "zsh" ? Shell::kZsh : Shell::kFish;
    // What is printed and ends the program with 0, in CLI11's words.
    throw CLI::CallForVersion(completion_script(app, kind), 0);
  });
}

}  // namespace landmarkdb::cli
