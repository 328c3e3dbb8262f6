#include "cli/interrupt.hpp"

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <mutex>
#include <thread>

#include <gtest/gtest.h>

namespace landmarkdb::cli {
namespace {

using namespace std::chrono_literals;

bool becomes_true(const std::stop_token& token) {
  std::mutex mutex;
  std::condition_variable_any changed;
  std::unique_lock lock(mutex);
  changed.wait_for(lock, token, 10s, [] { return false; });
  return token.stop_requested();
}

TEST(Interrupt, TurnsSigintIntoAStopRequest) {
  const Interrupt interrupt;
  EXPECT_FALSE(interrupt.token().stop_requested());
  std::raise(SIGINT);
  EXPECT_TRUE(becomes_true(interrupt.token()));
}

TEST(Interrupt, TurnsSigtermIntoAStopRequest) {
  const Interrupt interrupt;
  std::raise(SIGTERM);
  EXPECT_TRUE(becomes_true(interrupt.token()));
}

TEST(Interrupt, StartsAfreshEachTime) {
  {
    const Interrupt first;
    std::raise(SIGINT);
    EXPECT_TRUE(becomes_true(first.token()));
  }
  const Interrupt second;
  EXPECT_FALSE(second.token().stop_requested());
  std::raise(SIGINT);
  EXPECT_TRUE(becomes_true(second.token()));
}

TEST(Interrupt, PutsBackWhatWasThere) {
  std::signal(SIGINT, SIG_IGN);
  { const Interrupt interrupt; }
  EXPECT_EQ(std::signal(SIGINT, SIG_DFL), SIG_IGN);
}

TEST(InterruptDeathTest, TheSecondSignalKills) {
  ::testing::GTEST_FLAG(death_test_style) = "threadsafe";
  EXPECT_EXIT(
      {
        const Interrupt interrupt;
        std::raise(SIGINT);
        std::raise(SIGINT);
      },
      ::testing::KilledBySignal(SIGINT),
      "");
}

}  // namespace
}  // namespace landmarkdb::cli
