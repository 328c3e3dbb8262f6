#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

namespace landmarkdb {

// A value that is made when it is first asked for; others who ask meanwhile wait. What making it
// throws is passed on, and the next one who asks tries again. Who asks may say how it is to be made
// (`How`: on how many threads), which must not change what it is. Thread-safe.
template <typename Value, typename... How>
class Lazy {
 public:
  using Make = std::function<Value(How...)>;

  // Of a Value{}.
  Lazy() : Lazy(Make([](How...) { return Value{}; })) {}
  // `make` is let go once it has made the value.
  explicit Lazy(Make make) : state_(std::make_unique<State>(std::move(make))) {}

  // Stays where it is, whoever holds the Lazy.
  const Value& get(How... how) const {
    if (!state_->made.load(std::memory_order_acquire)) state_->make_once(how...);
    return state_->value;
  }

 private:
  struct State {
    explicit State(Make how) : make(std::move(how)) {}

    void make_once(How... how) {
      const std::lock_guard lock(making);
      if (made.load(std::memory_order_relaxed)) return;
      value = make(how...);
      make = nullptr;
      made.store(true, std::memory_order_release);
    }

    std::mutex making;
    Make make;
    Value value{};
    std::atomic<bool> made{false};
  };

  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb
