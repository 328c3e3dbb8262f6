#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace landmarkdb {

// A fixed number of threads and a bounded line before them. Thread-safe.
class WorkQueue {
 public:
  WorkQueue(int threads, std::size_t max_waiting)
      : threads_(static_cast<std::size_t>(threads)), max_waiting_(max_waiting), pool_(threads_) {}
  ~WorkQueue() { join(); }
  WorkQueue(const WorkQueue&) = delete;
  WorkQueue& operator=(const WorkQueue&) = delete;

  // False: the line is full and `work`, which must not throw, will not run.
  bool post(std::function<void()> work) {
    if (pending_.fetch_add(1) >= threads_ + max_waiting_) {
      --pending_;
      return false;
    }
    boost::asio::post(pool_, [this, work = std::move(work)]() mutable {
      ++running_;
      work();
      work = nullptr;  // what it holds goes before it counts as done
      --running_;
      --pending_;
    });
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
  std::size_t threads_;
  std::size_t max_waiting_;
  std::atomic<std::size_t> pending_{0};  // waiting and running
  std::atomic<std::size_t> running_{0};
  boost::asio::thread_pool pool_;
};

}  // namespace landmarkdb
