#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>
#include <sys/types.h>

#include "tests/support/temp_folder.hpp"

namespace landmarkdb::testing {

// How a program ended. `status` is its exit status; 128 + n after signal n.
struct Outcome {
  int status = -1;
  std::string out;
  std::string err;

  nlohmann::json json() const;  // of `out`; throws where that is no JSON
};

// A program of ours that runs, from the folder LANDMARKDB_BIN names. Killed when it goes out of
// scope.
class Running {
 public:
  Running(const std::string& program, const std::vector<std::string>& arguments);
  ~Running();
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void signal(int number) const;
  // Waits for its end. Throws std::runtime_error past the timeout.
  Outcome wait(std::chrono::seconds timeout = std::chrono::seconds(300));
  bool ended();
  std::string err_so_far() const;

 private:
  TempFolder folder_;
  pid_t pid_ = -1;
  int raw_status_ = 0;
  bool ended_ = false;
};

// Runs a program to its end.
Outcome run(const std::string& program, const std::vector<std::string>& arguments);

// A server over a database, listening on a free port of the loopback, or on the Unix socket when a
// path is given; ready when the constructor returns.
class ServerProcess {
 public:
  explicit ServerProcess(const std::string& db,
                         const std::vector<std::string>& arguments = {},
                         const std::string& unix_path = {});

  const std::string& address() const { return address_; }  // as the client's --server takes it
  Running& process() { return process_; }
  // Runs the client against it.
  Outcome client(std::vector<std::string> arguments) const;
  // SIGTERM, and its end.
  Outcome stop();

 private:
  Running process_;
  std::string address_;
};

}  // namespace landmarkdb::testing
