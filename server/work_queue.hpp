#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace landmarkdb {

// A fixed number of threads and a bounded line before them. Thread-safe.
class WorkQueue {
 public:
  // Called on the thread whose work has thrown; must not throw.
  using OnFailure = std::function<void(const std::string& what)>;

  WorkQueue(int threads, std::size_t max_waiting, OnFailure on_failure = {})
      : threads_(static_cast<std::size_t>(threads)),
        max_waiting_(max_waiting),
        on_failure_(std::move(on_failure)),
        pool_(threads_) {}
  ~WorkQueue() { join(); }
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  // False: the line is full and `work` will not run. What it throws goes to `on_failure`; the
  // threads go on.
  bool post(std::function<void()> work) {
    if (pending_.fetch_add(1) >= threads_ + max_waiting_) {
      --pending_;
      return false;
    }
    try {
      boost::asio::post(pool_, [this, work = std::move(work)]() mutable {
        ++running_;
        run(work);
        work = nullptr;  // what it holds goes before it counts as done
        --running_;
        --pending_;
      });
    } catch (...) {  // no memory for the line itself
      --pending_;
      throw;
    }
    return true;
  }

  std::size_t running() const { return running_; }
  std::size_t waiting() const {
    const std::size_t running = running_;
    const std::size_t pending = pending_;
    return pending > running ? pending - running : 0;
  }
  std::size_t threads() const { return threads_; }

  // Waits until everything posted is done.
  void join() { pool_.join(); }

 private:
  void run(const std::function<void()>& work) {
    try {
      work();
    } catch (const std::exception& error) {
      if (on_failure_) on_failure_(error.what());
    } catch (...) {
      if (on_failure_) on_failure_("an exception of no known kind");
    }
  }

  std::size_t threads_;
  std::size_t max_waiting_;
  OnFailure on_failure_;
  std::atomic<std::size_t> pending_{0};  // waiting and running
  std::atomic<std::size_t> running_{0};
  boost::asio::thread_pool pool_;
};

}  // namespace landmarkdb
