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

// Holds the only thread until it is opened.
class Gate {
 public:
  explicit Gate(WorkQueue& queue) {
    EXPECT_TRUE(queue.post(99, [this] {
      running_.set_value();
      open_.get_future().wait();
    }));
    running_.get_future().wait();
  }
  void open() { open_.set_value(); }

 private:
  std::promise<void> running_, open_;
};

// One owner's hundred held up another's single request for as long as all of them took.
TEST(WorkQueue, OwnersTakeTurnsEachInItsOwnOrder) {
  WorkQueue queue(1, 20);
  Gate gate(queue);
  std::string order;
  for (const char* name : {"a", "b", "c", "d"}) queue.post(1, [&order, name] { order += name; });
  for (const char* name : {"1", "2"}) queue.post(2, [&order, name] { order += name; });
  queue.post(3, [&order] { order += "x"; });
  gate.open();
  queue.join();
  EXPECT_EQ(order, "a1xb2cd");
}

TEST(WorkQueue, AFullLineMakesRoomForWhoHasLessInIt) {
  WorkQueue queue(1, 3);
  Gate gate(queue);
  std::string order, given_up;
  for (const char* name : {"a", "b", "c"}) {
    EXPECT_TRUE(queue.post(
        1, [&order, name] { order += name; }, [&given_up, name] { given_up += name; }));
  }
  EXPECT_FALSE(queue.post(1, [&order] { order += "d"; }));
  EXPECT_TRUE(queue.post(2, [&order] { order += "x"; }));
  EXPECT_EQ(given_up, "c");
  EXPECT_FALSE(queue.post(2, [&order] { order += "y"; })) << "it has as many as the other but one";
  EXPECT_EQ(queue.waiting(), 3U);
  gate.open();
  queue.join();
  EXPECT_EQ(order, "axb");
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
