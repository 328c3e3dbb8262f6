#include "server/work_queue.hpp"

#include <future>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "server/memory_budget.hpp"

namespace landmarkdb {
namespace {

TEST(WorkQueue, TurnsWorkAwayWhenItsLineIsFull) {
  WorkQueue queue(1, 2);
  std::promise<void> gate;
  std::promise<void> running;
  std::shared_future<void> open = gate.get_future().share();
  ASSERT_TRUE(queue.post([&] {
    running.set_value();
    open.wait();
  }));
  running.get_future().wait();
  std::atomic<int> done{0};
  EXPECT_TRUE(queue.post([&] { ++done; }));
  EXPECT_TRUE(queue.post([&] { ++done; }));
  EXPECT_FALSE(queue.post([&] { ++done; }));
  EXPECT_EQ(queue.waiting(), 2U);
  EXPECT_EQ(queue.running(), 1U);
  gate.set_value();
  queue.join();
  EXPECT_EQ(done, 2);
  EXPECT_EQ(queue.waiting(), 0U);
}

// An exception on a pool's thread would end the whole process.
TEST(WorkQueue, GoesOnAfterWorkThatThrows) {
  std::vector<std::string> failures;
  std::atomic<int> done{0};
  WorkQueue queue(1, 5, [&](const std::string& what) { failures.push_back(what); });
  ASSERT_TRUE(queue.post([] { throw std::runtime_error("no luck"); }));
  ASSERT_TRUE(queue.post([] { throw 3; }));
  ASSERT_TRUE(queue.post([&] { ++done; }));
  queue.join();
  EXPECT_EQ(done, 1);
  EXPECT_EQ(failures, (std::vector<std::string>{"no luck", "an exception of no known kind"}));
  EXPECT_EQ(queue.waiting(), 0U);
  EXPECT_EQ(queue.running(), 0U);
}

TEST(MemoryBudget, GivesOutNoMoreThanItHasAndTakesItBack) {
  MemoryBudget budget(100);
  {
    MemoryBudget::Lease first = budget.reserve(60);
    EXPECT_TRUE(static_cast<bool>(first));
    EXPECT_FALSE(static_cast<bool>(budget.reserve(41)));
    MemoryBudget::Lease moved = std::move(first);
    EXPECT_EQ(budget.left(), 40U);
    moved = MemoryBudget::Lease();
    EXPECT_EQ(budget.left(), 100U);
    moved = budget.reserve(100);
    EXPECT_EQ(budget.left(), 0U);
  }
  EXPECT_EQ(budget.left(), 100U);
}

}  // namespace
}  // namespace landmarkdb
