#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include <boost/asio/post.hpp>
#include <boost/asio/thread_pool.hpp>

namespace landmarkdb {

// A fixed number of threads and a bounded line before them, in which owners (connections) take
// turns: each owner's work is done in the order it came, and the one that waits longest for its
// turn is next. So one that sends much waits for itself, not others for it. Thread-safe.
class WorkQueue {
 public:
  using Owner = std::uint64_t;
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
  //
  // In a full line an owner with less in it than another takes the place of the last of the longest
  // part that came with `give_up`: that is called here, in place of that work.
  bool post(Owner owner, std::function<void()> work, std::function<void()> give_up = {}) {
    std::function<void()> given_up;
    {
      const std::lock_guard lock(mutex_);
      const bool full = pending_ >= threads_ + max_waiting_;
      if (full) {
        given_up = make_room_for(owner);
        if (!given_up) return false;
      }
      std::deque<Waiting>& line = lines_[owner];
      line.push_back({std::move(work), std::move(give_up)});
      if (line.size() == 1) turns_.push_back(owner);
      if (!full) {
        ++pending_;
        boost::asio::post(pool_, [this] { run_next(); });  // takes whatever is next by then
      }
    }
    if (given_up) given_up();
    return true;
  }
  bool post(std::function<void()> work) { return post(0, std::move(work)); }

  std::size_t running() const { return running_; }
  std::size_t waiting() const {
    const std::lock_guard lock(mutex_);
    const std::size_t running = running_;
    return pending_ > running ? pending_ - running : 0;
  }
  std::size_t threads() const { return threads_; }

  // Waits until everything posted is done.
  void join() { pool_.join(); }

 private:
  struct Waiting {
    std::function<void()> work;
    std::function<void()> give_up;  // empty: it will not be given up
  };

  // Takes the last work of the owner with most in the line out of it, if that has at least two more
  // than `owner`, and returns what is to be called for it. Empty: there is none. Under the mutex.
  std::function<void()> make_room_for(Owner owner) {
    const auto own = lines_.find(owner);
    const std::size_t mine = own == lines_.end() ? 0 : own->second.size();
    const auto longest = std::max_element(lines_.begin(), lines_.end(), [](auto& a, auto& b) {
      return a.second.size() < b.second.size();
    });
    if (longest == lines_.end() || longest->second.size() < mine + 2) return {};
    std::function<void()> given_up = std::move(longest->second.back().give_up);
    if (given_up) longest->second.pop_back();  // never the only one: its turn stays
    return given_up;
  }

  std::function<void()> take_next() {
    const std::lock_guard lock(mutex_);
    const auto line = lines_.find(turns_.front());
    turns_.pop_front();
    std::function<void()> work = std::move(line->second.front().work);
    line->second.pop_front();
    if (line->second.empty()) {
      lines_.erase(line);
    } else {
      turns_.push_back(line->first);
    }
    ++running_;
    return work;
  }

  void run_next() {
    std::function<void()> work = take_next();
    try {
      work();
    } catch (const std::exception& error) {
      if (on_failure_) on_failure_(error.what());
    } catch (...) {
      if (on_failure_) on_failure_("an exception of no known kind");
    }
    work = nullptr;  // what it holds goes before it counts as done
    const std::lock_guard lock(mutex_);
    --running_;
    --pending_;
  }

  std::size_t threads_;
  std::size_t max_waiting_;
  OnFailure on_failure_;
  std::atomic<std::size_t> running_{0};
  mutable std::mutex mutex_;                    // of all below
  std::size_t pending_ = 0;                     // waiting and running
  std::map<Owner, std::deque<Waiting>> lines_;  // those of owners that wait
  std::deque<Owner> turns_;                     // each of these once, the next first
  boost::asio::thread_pool pool_;
};

}  // namespace landmarkdb
