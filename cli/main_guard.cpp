#include "cli/main_guard.hpp"

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Error.hpp>
#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::cli {
namespace {

struct Failure {
  std::string_view code;
  std::string message;
  std::string field;
  int status = kExitInternal;
};

// The program and the subcommands that were being parsed, outermost first.
std::vector<const CLI::App*> commands_in_use(const CLI::App& app) {
  std::vector<const CLI::App*> commands{&app};
  while (!commands.back()->get_subcommands().empty()) {
    commands.push_back(commands.back()->get_subcommands().front());
  }
  return commands;
}

// The word that stands where a command is wanted; empty where none does.
std::string unknown_command(const CLI::App& app) {
  const CLI::App& last = *commands_in_use(app).back();
  if (last.get_require_subcommand_min() == 0) return {};
  const std::vector<std::string> rest = app.remaining(true);
  const auto word = std::find_if(
      rest.begin(), rest.end(), [](const std::string& one) { return !one.starts_with('-'); });
  return word == rest.end() ? std::string() : *word;
}

// "landmarkdb-indexer add", for the hint at its --help.
std::string command_in_use(const CLI::App& app) {
  std::string command;
  for (const CLI::App* one : commands_in_use(app)) {
    command += (command.empty() ? "" : " ") + one->get_name();
  }
  return command;
}

// The option, as it is typed, that gave the field which an error names ("options.min_confidence"),
// wherever the value was found wrong; empty where none did, or a file did that it names.
std::string option_of_field(const CLI::App& app, const std::string& field) {
  std::string name = field.substr(field.rfind('.') + 1);  // npos + 1 is 0
  std::replace(name.begin(), name.end(), '_', '-');
  if (!name.starts_with("--")) name = "--" + name;
  for (const CLI::App* command : commands_in_use(app)) {
    const CLI::Option* option = command->get_option_no_throw(name);
    if (option == nullptr || option->count() == 0) continue;
    const std::string takes = option->get_type_name();
    if (takes.find("FILE") == std::string::npos && takes.find("PATH") == std::string::npos) {
      return name;
    }
  }
  return {};
}

Failure usage_failure(const CLI::App& app, const std::string& what, const std::string& field) {
  return {error_code_name(ErrorCode::kInvalidArgument),
          what + " (see " + command_in_use(app) + " --help)",
          field,
          kExitUsage};
}

// Describes the exception in flight; call from a catch block only.
Failure failure_in_flight(const CLI::App& app) {
  try {
    throw;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInvalidArgument && !error.field().empty()) {
      const std::string option = option_of_field(app, error.field());
      if (!option.empty()) return usage_failure(app, error.what(), option);
    }
    return {error_code_name(error.code()), error.what(), error.field(), exit_status(error.code())};
  } catch (const UsageError& error) {
    return usage_failure(app, error.what(), error.option());
  } catch (const CLI::Error& error) {
    const std::string unknown = unknown_command(app);
    return usage_failure(
        app, unknown.empty() ? error.what() : "there is no command '" + unknown + "'", {});
  } catch (const std::bad_alloc&) {
    return {error_code_name(ErrorCode::kInternal), "out of memory", {}, kExitInternal};
  } catch (const std::exception& error) {
    return {error_code_name(ErrorCode::kInternal),
            std::string("internal error: ") + error.what(),
            {},
            kExitInternal};
  }
}

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

int report(const CLI::App& app, const Failure& failure, bool json) {
  if (json) {
    std::cout << json_error(failure.code, failure.message, failure.field, failure.status)
              << std::endl;
  } else {
    std::cerr << app.get_name() << ": " << printable(one_line(failure.message)) << std::endl;
  }
  return failure.status;
}

int parse_and_run(int argc,
                  const char* const* argv,
                  CLI::App& app,
                  const std::function<int()>& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) throw;
    app.exit(error, std::cout, std::cerr);
    return 0;
  }
  return body();
}

}  // namespace

bool wants_json(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--") return false;
    if (argument == "--json") return true;
  }
  return false;
}

std::string json_error(std::string_view code,
                       std::string_view message,
                       std::string_view field,
                       int exit_status) {
  const nlohmann::ordered_json object = {
      {"error",
       {{"code", code}, {"message", message}, {"field", field}, {"exit_status", exit_status}}}};
  // File names need not be UTF-8; what is not comes out as U+FFFD rather than as an exception.
  return object.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

int run_main(int argc, const char* const* argv, CLI::App& app, const std::function<int()>& body) {
  // Past a file-size limit the kernel sends SIGXFSZ; ignored, the write fails with EFBIG instead
  // and the transaction is rolled back.
  std::signal(SIGXFSZ, SIG_IGN);
  const bool json = wants_json(argc, argv);
  int status = kExitInternal;
  try {
    status = parse_and_run(argc, argv, app, body);
  } catch (...) {
    status = report(app, failure_in_flight(app), json);
  }
  std::cout.flush();
  if (!std::cout && status == 0) {
    std::cerr << app.get_name() << ": standard output cannot be written" << std::endl;
    status = kExitUnavailable;
  }
  return status;
}

}  // namespace landmarkdb::cli
