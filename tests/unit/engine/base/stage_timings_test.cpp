#include "engine/base/stage_timings.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(StageTimer, AddsToWhatIsThereWhenItsBlockEnds) {
  StageTimings timings;
  timings.icp = StageTimings::Duration(100.0);
  {
    const StageTimer timer(timings.icp);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(timings.icp.count(), 100.0);
  }
  EXPECT_GE(timings.icp.count(), 101.0);  // a sleep is never shorter
  EXPECT_EQ(timings.match.count(), 0.0);
}

}  // namespace
}  // namespace landmarkdb
