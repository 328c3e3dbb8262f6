#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace landmarkdb::indexer::testing {

// How a program is run.
struct RunOptions {
  std::optional<std::uint64_t> max_file_bytes{};  // RLIMIT_FSIZE: a disk that is full past this
  bool as_nobody = false;                         // gives up root's right to write anywhere
  // Standard error is a terminal, and as soon as this text appears on it the program gets the
  // signal.
  std::string signal_at{};
  int signal = 0;
};

struct RunResult {
  int status = -1;  // as a shell reports it: 128 + n for a program killed by signal n
  std::string out;
  std::string err;
};

// False where no pseudo-terminal can be had (a bare container without /dev/pts): then `signal_at`
// does not work.
bool has_terminals();

// Runs an installed or built program, found in the folder that LANDMARKDB_BIN names, to its end.
RunResult run_program(const std::string& name,
                      const std::vector<std::string>& arguments,
                      const RunOptions& options = {});

}  // namespace landmarkdb::indexer::testing
