#pragma once

#include <memory>
#include <string>
#include <utility>

#include <CLI/App.hpp>
#include <CLI/Option.hpp>

#include "client/program.hpp"
#include "client/session.hpp"

namespace landmarkdb::client {

// A command whose whole work is one request: `request(session)` asks, `print(answer)` prints once
// the progress bar is gone.
template <typename Request, typename Print>
void on_request(CLI::App& command, Program& program, Request request, Print print) {
  command.callback([request = std::move(request), print = std::move(print), &program] {
    program.action = [request, print, &program] {
      Session session(program.options);
      const auto answer = request(session);
      session.finish();
      print(answer);
      return 0;
    };
  });
}

// The argument NAME, and what it will hold once the command line is parsed. `what`: "scene".
inline std::shared_ptr<const std::string> add_name(CLI::App& command, const std::string& what) {
  const auto name = std::make_shared<std::string>();
  command.add_option("NAME", *name, "Name of the " + what)->required();
  return name;
}

struct Renaming {
  std::string from, to;
};

// The arguments OLD and NEW.
inline std::shared_ptr<const Renaming> add_renaming(CLI::App& command, const std::string& what) {
  const auto names = std::make_shared<Renaming>();
  command.add_option("OLD", names->from, "Name of the " + what)->required();
  command.add_option("NEW", names->to, "Its new name")->required();
  return names;
}

}  // namespace landmarkdb::client
