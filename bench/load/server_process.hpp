#pragma once

#include <chrono>
#include <cstdint>
#include <string>

#include <sys/types.h>

#include "tests/support/temp_folder.hpp"

namespace landmarkdb::bench {

// A landmarkdb-server of its own, from this program's folder, on a Unix socket; killed when it goes
// out of scope.
class ServerProcess {
 public:
  // Returns once queries are answered. `threads`: of the server; 0: one a core. Throws
  // Error{kUnavailable} when it ends before that, or takes longer than ten minutes.
  ServerProcess(const std::string& db, int threads);
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  const std::string& address() const { return address_; }  // as ConnectOptions::server
  double seconds_until_ready() const { return seconds_until_ready_; }
  // The most it has held in RAM so far, from /proc; 0 where that cannot be read.
  std::uint64_t peak_resident_bytes() const;

 private:
  void wait_until_ready(std::chrono::steady_clock::time_point start);

  testing::TempFolder folder_;
  std::string address_;
  pid_t pid_ = -1;
  double seconds_until_ready_ = 0.0;
};

}  // namespace landmarkdb::bench
