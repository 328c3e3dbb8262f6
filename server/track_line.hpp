#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "server/track_store.hpp"
#include "server/work_queue.hpp"

namespace landmarkdb {

// The tracks of one connection, and the work on them: one piece at a time, in the order it came,
// on whatever thread of the queue is free. Lives as long as its connection or its last piece of
// work. post() may be called from any thread.
class TrackLine {
 public:
  using Work = std::function<void()>;

  // `owner`: whose turn in the queue its work takes.
  explicit TrackLine(Counters& counters, WorkQueue::Owner owner = 0)
      : tracks_(counters), owner_(owner) {}

  // Only for the work itself.
  TrackStore& tracks() { return tracks_; }

  // False: `queue` is full and `work` will not run.
  static bool post(const std::shared_ptr<TrackLine>& line, WorkQueue& queue, Work work) {
    const std::lock_guard lock(line->mutex_);
    line->waiting_.push_back(std::move(work));
    if (line->running_) return true;
    try {
      line->running_ = queue.post(line->owner_, [line, &queue] { run(line, queue); });
    } catch (...) {
      line->waiting_.pop_back();
      throw;
    }
    if (!line->running_) line->waiting_.pop_back();
    return line->running_;
  }

 private:
  // Does one piece and goes to the end of the queue for the next, so that others have their turn.
  static void run(const std::shared_ptr<TrackLine>& line, WorkQueue& queue) {
    std::exception_ptr failure;
    while (true) {
      try {
        line->take()();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(line->mutex_);
      line->running_ = !line->waiting_.empty();
      if (!line->running_) break;
      bool queued = false;
      try {
        queued = queue.post(line->owner_, [line, &queue] { run(line, queue); });
      } catch (...) {
        queued = false;  // then it goes on here
      }
      if (queued) break;
    }
    if (failure) std::rethrow_exception(failure);
  }

  Work take() {
    const std::lock_guard lock(mutex_);
    Work work = std::move(waiting_.front());
    waiting_.pop_front();
    return work;
  }

  TrackStore tracks_;
  const WorkQueue::Owner owner_;
  std::mutex mutex_;  // guards what is below
  std::deque<Work> waiting_;
  bool running_ = false;
};

}  // namespace landmarkdb
