#include "server/track_line.hpp"

#include <future>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;

TEST(TrackLine, WorksInOrderOnAQueueOfManyThreads) {
  Counters counters;
  const auto line = std::make_shared<TrackLine>(counters);
  std::vector<int> seen;  // two at a time would be a race
  std::vector<int> want;
  {
    WorkQueue queue(4, 1000);
    for (int i = 0; i < 500; ++i) {
      want.push_back(i);
      EXPECT_TRUE(TrackLine::post(line, queue, [&seen, i] { seen.push_back(i); }));
    }
  }
  EXPECT_EQ(seen, want);
}

TEST(TrackLine, SaysWhenTheQueueIsFull) {
  Counters counters;
  const auto line = std::make_shared<TrackLine>(counters);
  std::promise<void> go;
  bool ran = false;
  {
    WorkQueue queue(1, 0);
    queue.post([gate = go.get_future().share()] { gate.wait(); });
    EXPECT_FALSE(TrackLine::post(line, queue, [&ran] { ran = true; }));
    go.set_value();
  }
  EXPECT_FALSE(ran);
  WorkQueue queue(1, 0);
  EXPECT_TRUE(TrackLine::post(line, queue, [&ran] { ran = true; }));
  queue.join();
  EXPECT_TRUE(ran);
}

TEST(TrackLine, GoesOnAfterWorkThatThrows) {
  Counters counters;
  const auto line = std::make_shared<TrackLine>(counters);
  std::vector<std::string> told;
  std::vector<int> seen;
  {
    WorkQueue queue(1, 10, [&told](const std::string& what) { told.push_back(what); });
    TrackLine::post(line, queue, [] { throw std::runtime_error("broken"); });
    TrackLine::post(line, queue, [&seen] { seen.push_back(1); });
  }
  EXPECT_THAT(told, ElementsAre("broken"));
  EXPECT_THAT(seen, ElementsAre(1));
}

}  // namespace
}  // namespace landmarkdb
