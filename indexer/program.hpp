#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace landmarkdb::indexer {

// What every command sees of the command line, and what the parser chose to run. Subcommands hold
// a reference: it lives in main.
struct Program {
  std::string db;
  bool json = false;
  bool quiet = false;
  int threads = 0;  // 0: one a core

  std::function<int()> action;  // what the parsed subcommand asks for; its result ends the program

  // The database's path; UsageError when --db was not given.
  const std::string& database() const;
  int thread_count() const;

  // Prints a result: the object with --json, the text otherwise.
  void print(const nlohmann::ordered_json& object, const std::string& text) const;
  // A sentence for people, on standard error unless --quiet.
  void note(const std::string& sentence) const;
};

}  // namespace landmarkdb::indexer
