#pragma once

#include <iostream>

#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "engine/base/run_context.hpp"
#include "indexer/program.hpp"

namespace landmarkdb::indexer {

// What a command that may take long runs under: Ctrl-C stops it, progress goes to standard error.
class LongJob {
 public:
  explicit LongJob(const Program& program) : bar_(cli::progress_style(program.quiet), std::cerr) {
    context_.stop = interrupt_.token();
    context_.progress = bar_.callback();
    context_.threads = program.thread_count();
  }

  const RunContext& context() const { return context_; }
  // Before anything else is printed.
  void finish_progress() { bar_.finish(); }

 private:
  cli::Interrupt interrupt_;
  cli::ProgressBar bar_;
  RunContext context_;
};

}  // namespace landmarkdb::indexer
