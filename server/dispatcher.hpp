#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>

#include "proto/landmarkdb.pb.h"
#include "server/log.hpp"
#include "server/memory_budget.hpp"
#include "server/request_handler.hpp"
#include "server/track_line.hpp"
#include "server/work_queue.hpp"

namespace landmarkdb {

// One request on its way: shared by its connection, which may stop it, and the thread that works on
// it.
struct Job {
  using Clock = std::chrono::steady_clock;
  v1::Envelope request;
  std::uint64_t connection = 0;  // for the log
  Clock::time_point arrived = Clock::now();
  std::optional<Clock::time_point> deadline;
  std::stop_source stop;
  std::function<void(const Progress&)> progress;  // called from the working thread
  MemoryBudget::Lease memory;
  std::shared_ptr<TrackLine> tracks;  // of its connection; may be null

  // True for the first caller only: whoever claims the job answers it.
  bool claim() { return !claimed_.exchange(true); }

 private:
  std::atomic<bool> claimed_{false};
};

// Sends requests to the thread that may work on them and logs what became of each. Thread-safe.
class Dispatcher {
 public:
  using Answer = std::function<void(v1::Envelope)>;

  // All must outlive the dispatcher. `threads`: of the whole machine, shared by running queries.
  Dispatcher(RequestHandler& handler,
             WorkQueue& compute,
             WorkQueue& writes,
             Counters& counters,
             Logger& log,
             int threads)
      : handler_(handler),
        compute_(compute),
        writes_(writes),
        counters_(counters),
        log_(log),
        threads_(threads) {}

  // `answer` is called once, here or on another thread, unless somebody else claims the job first.
  void submit(const std::shared_ptr<Job>& job, Answer answer);

  // The answer for a job that was claimed and not worked on.
  v1::Envelope refuse(const Job& job, ErrorCode code, const std::string& message);

 private:
  // False: the queue is full.
  bool enqueue(Lane lane, const std::shared_ptr<Job>& job, const Answer& answer);
  // The answer of a queue that is full.
  void turn_away(Job& job, const Answer& answer);
  // Works on the job, unless somebody has claimed it, and answers whatever happens.
  void run(Job& job, const Answer& answer);
  v1::Envelope work(Job& job);
  int threads_for(Lane lane) const;
  void log_outcome(const Job& job, const v1::Envelope& reply, Job::Clock::time_point started);

  RequestHandler& handler_;
  WorkQueue& compute_;
  WorkQueue& writes_;
  Counters& counters_;
  Logger& log_;
  int threads_;
};

}  // namespace landmarkdb
