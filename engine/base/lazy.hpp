#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace landmarkdb {

// A value that is made when it is first asked for; others who ask meanwhile wait. What making it
// throws is passed on, and the next one who asks tries again. Thread-safe.
template <typename Value>
class Lazy {
 public:
  // Of a Value{}.
  Lazy() : Lazy([] { return Value{}; }) {}
  // `make` is let go once it has made the value.
  explicit Lazy(std::function<Value()> make) : state_(std::make_unique<State>(std::move(make))) {}

  // Stays where it is, whoever holds the Lazy.
  const Value& get() const {
    if (!state_->made.load(std::memory_order_acquire)) state_->make_once();
    return state_->value;
  }

 private:
  struct State {
    explicit State(std::function<Value()> how) : make(std::move(how)) {}

    void make_once() {
      const std::lock_guard lock(making);
      if (made.load(std::memory_order_relaxed)) return;
      value = make();
      make = nullptr;
      made.store(true, std::memory_order_release);
    }

    std::mutex making;
    std::function<Value()> make;
    Value value{};
    std::atomic<bool> made{false};
  };

  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb
