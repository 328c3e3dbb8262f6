#pragma once

#include <functional>
#include <string_view>

#include <CLI/App.hpp>

namespace landmarkdb::cli {

inline constexpr int kExitInternal = 1;
inline constexpr int kExitUsage = 2;
inline constexpr int kExitUnavailable = 8;

// The last wall of a program: parses the command line into `app`, runs `body` and returns the exit
// status for main to return.
//
// --help, --version and the like print to standard output and end with 0. What is thrown becomes
// one line on standard error, or, when the arguments hold --json, one JSON object on standard
// output: {"error": {"code", "message", "field", "exit_status"}}. Statuses: landmarkdb::Error as
// exit_status() says; wrong usage 2; anything else, memory included, 1. Standard output that cannot
// be written (a full disk, /dev/full) ends with 8. A file-size limit shows up as a failed write,
// not as a deadly signal.
int run_main(int argc, const char* const* argv, CLI::App& app, const std::function<int()>& body);

// True when --json is among the arguments (before a "--"), so that even the errors of a command
// line that cannot be parsed come in the form that was asked for.
bool wants_json(int argc, const char* const* argv);

// The error object, one line without its newline. `code` is a gRPC code name.
std::string json_error(std::string_view code,
                       std::string_view message,
                       std::string_view field,
                       int exit_status);

}  // namespace landmarkdb::cli
