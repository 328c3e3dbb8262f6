#pragma once

#include <functional>

#include <CLI/App.hpp>

namespace landmarkdb::datasets {

// What every command sees of the command line, and what the parser chose to run. Lives in main.
struct Generator {
  bool json = false;
  bool quiet = false;
  int threads = 0;  // 0: one a core

  std::function<int()> action;

  int thread_count() const;
};

void add_place_command(CLI::App& app, Generator& generator);
void add_many_command(CLI::App& app, Generator& generator);
void add_list_command(CLI::App& app, Generator& generator);
void add_picture_command(CLI::App& app, Generator& generator);

}  // namespace landmarkdb::datasets
