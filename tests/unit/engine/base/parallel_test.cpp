#include "engine/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

TEST(ParallelChunks, CoversEachIndexOnceForAnySizeAndThreadCount) {
  for (const std::size_t n : {1U, 2U, 3U, 7U, 64U, 1001U}) {
    for (const int threads : {-1, 0, 1, 2, 3, 8, 100}) {
      std::vector<std::atomic<int>> visits(n);
      parallel_chunks(n, threads, [&](std::size_t begin, std::size_t end) {
        ASSERT_LE(begin, end);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const std::atomic<int>& count : visits) ASSERT_EQ(count, 1) << n << ", " << threads;
    }
  }
}

TEST(ParallelEach, VisitsEachIndexOnceForAnySizeAndThreadCount) {
  for (const std::size_t n : {0U, 1U, 3U, 64U, 1001U}) {
    for (const int threads : {-1, 1, 2, 8, 100}) {
      std::vector<std::atomic<int>> visits(n);
      parallel_each(n, threads, [&](std::size_t i) { ++visits[i]; });
      for (const std::atomic<int>& count : visits) ASSERT_EQ(count, 1) << n << ", " << threads;
    }
  }
}

TEST(ParallelRuns, CutsIntoRunsOfOneLengthAndTheRest) {
  for (const int threads : {1, 3}) {
    std::mutex mutex;
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    parallel_runs(10, 4, threads, [&](std::size_t begin, std::size_t end) {
      const std::lock_guard lock(mutex);
      runs.emplace_back(begin, end);
    });
    std::sort(runs.begin(), runs.end());
    const std::vector<std::pair<std::size_t, std::size_t>> expected{{0, 4}, {4, 8}, {8, 10}};
    EXPECT_EQ(runs, expected);
  }
}

TEST(ParallelChunks, CutsIntoEqualContiguousChunksAndNoMoreThanAsked) {
  std::mutex mutex;
  std::vector<std::pair<std::size_t, std::size_t>> chunks;
  parallel_chunks(10, 4, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace_back(begin, end);
  });
  ASSERT_EQ(chunks.size(), 4U);
  std::sort(chunks.begin(), chunks.end());
  std::size_t next = 0;
  for (const auto& [begin, end] : chunks) {
    EXPECT_EQ(begin, next);
    EXPECT_GE(end - begin, 2U);
    EXPECT_LE(end - begin, 3U);
    next = end;
  }
  EXPECT_EQ(next, 10U);
}

TEST(ParallelChunks, HasNothingToVisitInAnEmptyRange) {
  parallel_chunks(0, 8, [&](std::size_t begin, std::size_t end) { EXPECT_EQ(begin, end); });
}

TEST(ParallelChunks, StaysOnTheCallingThreadWithOneThread) {
  parallel_chunks(100, 1, [caller = std::this_thread::get_id()](std::size_t, std::size_t) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
  });
}

TEST(ParallelChunks, RethrowsTheErrorOfTheLowestChunkAfterAllHaveEnded) {
  for (int round = 0; round < 20; ++round) {
    std::atomic<int> ended{0};
    try {
      parallel_chunks(4, 4, [&](std::size_t begin, std::size_t) {
        if (begin == 1) std::this_thread::yield();
        ++ended;
        if (begin > 0) throw std::runtime_error(std::to_string(begin));
      });
      FAIL() << "the error was lost";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "1");
    }
    EXPECT_EQ(ended, 4);
  }
}

TEST(ParallelChunks, GivesTheSameResultForAnyThreadCount) {
  const auto squares = [](int threads) {
    std::vector<double> values(1000);
    parallel_chunks(values.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) values[i] = 1.0 / (1.0 + static_cast<double>(i));
    });
    return values;
  };
  EXPECT_EQ(squares(1), squares(2));
  EXPECT_EQ(squares(1), squares(7));
}

}  // namespace
}  // namespace landmarkdb
