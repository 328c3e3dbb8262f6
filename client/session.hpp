#pragma once

#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "client/client.hpp"
#include "client/global_options.hpp"
#include "engine/base/run_context.hpp"

namespace landmarkdb::client {

// What one command of the program works with: the deadline counts from construction, Ctrl-C stops
// the request, progress is drawn on standard error. connect() throws as Client does.
class Session {
 public:
  explicit Session(const GlobalOptions& options);

  Client& connect();
  const RunContext& context() const { return context_; }
  // Takes the progress bar away; call before printing.
  void finish() { bar_.finish(); }

 private:
  GlobalOptions options_;
  cli::Interrupt interrupt_;
  cli::ProgressBar bar_;
  RunContext context_;
  std::optional<Client> client_;
};

}  // namespace landmarkdb::client
