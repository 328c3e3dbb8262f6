#pragma once

#include <atomic>
#include <cstddef>
#include <utility>

namespace landmarkdb {

// A number of bytes that many share. Thread-safe; must outlive its leases.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::size_t bytes) : bytes_(bytes), left_(bytes) {}

  // A part of the budget, given back when it goes.
  class Lease {
   public:
    Lease() = default;
    Lease(Lease&& other) noexcept
        : budget_(std::exchange(other.budget_, nullptr)), bytes_(std::exchange(other.bytes_, 0)) {}
    Lease& operator=(Lease&& other) noexcept {
      std::swap(budget_, other.budget_);
      std::swap(bytes_, other.bytes_);
      return *this;
    }
    ~Lease() {
      if (budget_ != nullptr) budget_->left_ += bytes_;
    }
    explicit operator bool() const { return budget_ != nullptr; }

   private:
    friend class MemoryBudget;
    Lease(MemoryBudget* budget, std::size_t bytes) : budget_(budget), bytes_(bytes) {}
    MemoryBudget* budget_ = nullptr;
    std::size_t bytes_ = 0;
  };

  // An empty lease when there is not that much left.
  Lease reserve(std::size_t bytes) {
    std::size_t left = left_;
    do {
      if (left < bytes) return {};
    } while (!left_.compare_exchange_weak(left, left - bytes));
    return {this, bytes};
  }

  std::size_t bytes() const { return bytes_; }  // in all
  std::size_t left() const { return left_; }

 private:
  std::size_t bytes_;
  std::atomic<std::size_t> left_;
};

}  // namespace landmarkdb
