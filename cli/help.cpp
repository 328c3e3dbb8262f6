#include "cli/help.hpp"

#include "cli/completion.hpp"
#include "cli/help_text.hpp"
#include "cli/man_page.hpp"
#include "cli/version.hpp"

namespace landmarkdb::cli {
namespace {

std::string examples_text(const std::vector<Example>& examples) {
  std::string text = examples.empty() ? "" : "Examples:";
  for (const Example& example : examples) {
    text += "\n  " + example.command;
    if (!example.effect.empty()) text += "\n      " + example.effect;
  }
  return text;
}

void describe(CLI::App& app, const std::vector<Example>& examples) {
  app.footer(examples_text(examples));
  app.set_version_flag(
      "--version", version_text(program_of(app).get_name()), "Print the versions and exit");
}

}  // namespace

const CLI::App& program_of(const CLI::App& app) {
  const CLI::App* top = &app;
  while (top->get_parent() != nullptr) top = top->get_parent();
  return *top;
}

void set_up_program(CLI::App& app,
                    const std::string& name,
                    const std::string& description,
                    const std::vector<Example>& examples) {
  app.name(name);
  app.description(description);
  app.formatter_fn([](const CLI::App* command, const std::string&, CLI::AppFormatMode) {
    return help_text(*command);
  });
  app.set_help_flag("-h,--help", "Print this help and exit");
  describe(app, examples);
  add_completion_command(app);
  add_man_command(app);
}

CLI::App* add_command(CLI::App& parent,
                      const std::string& name,
                      const std::string& description,
                      const std::vector<Example>& examples) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->fallthrough();
  describe(*command, examples);
  return command;
}

CLI::Option* add_repeated(CLI::App& app,
                          const std::string& names,
                          std::vector<std::string>& values,
                          const std::string& description) {
  // CLI11 heeds allow_extra_args(false) for options without a real upper bound only.
  constexpr int kUnbounded = CLI::detail::expected_max_vector_size;
  return app.add_option(names, values, description)
      ->expected(1, kUnbounded)
      ->allow_extra_args(false);
}

}  // namespace landmarkdb::cli
