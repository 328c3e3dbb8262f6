#pragma once

#include <iostream>

#include "cli/interrupt.hpp"
#include "cli/progress_bar.hpp"
#include "datasets/generate/commands.hpp"
#include "engine/base/run_context.hpp"

namespace landmarkdb::datasets {

// What a command runs under: Ctrl-C stops it, progress goes to standard error.
class Job {
 public:
  explicit Job(const Generator& generator) : bar_(cli::progress_style(generator.quiet), std::cerr) {
    context_.stop = interrupt_.token();
    context_.progress = bar_.callback();
    context_.threads = generator.thread_count();
  }

  const RunContext& context() const { return context_; }
  // The same without a word of its own: for the steps of a job that counts them itself.
  RunContext quiet_context() const {
    RunContext context = context_;
    context.progress = nullptr;
    return context;
  }
  void finish_progress() { bar_.finish(); }

 private:
  cli::Interrupt interrupt_;
  cli::ProgressBar bar_;
  RunContext context_;
};

}  // namespace landmarkdb::datasets
