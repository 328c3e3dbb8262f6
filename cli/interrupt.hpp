#pragma once

#include <memory>
#include <stop_token>

namespace landmarkdb::cli {

// While one lives, SIGINT and SIGTERM ask the program's long job to stop instead of killing it; a
// second one kills. At most one at a time. The handler only writes a byte; a thread of its own
// turns that into the stop request, so any callback may hang on the token.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb::cli
