#include "engine/base/lazy.hpp"

#include <atomic>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "engine/base/parallel.hpp"

namespace landmarkdb {
namespace {

TEST(Lazy, IsMadeOnceWhoeverAsks) {
  std::atomic<int> made{0};
  const Lazy<std::string> lazy([&] {
    ++made;
    return std::string("value");
  });
  EXPECT_EQ(made, 0);
  std::atomic<int> right{0};
  parallel_chunks(8, 8, [&](std::size_t, std::size_t) { right += lazy.get() == "value" ? 1 : 0; });
  EXPECT_EQ(right, 8);
  EXPECT_EQ(made, 1);
}

TEST(Lazy, WhatMakingItThrowsIsPassedOnAndTriedAgain) {
  int tries = 0;
  const Lazy<int> lazy([&] {
    if (++tries == 1) throw std::runtime_error("not yet");
    return 7;
  });
  EXPECT_THROW(lazy.get(), std::runtime_error);
  EXPECT_EQ(lazy.get(), 7);
  EXPECT_EQ(lazy.get(), 7);
  EXPECT_EQ(tries, 2);
}

TEST(Lazy, TheValueStaysWhereItIsAndWhatMadeItIsLetGo) {
  auto held = std::make_shared<int>(5);
  Lazy<int> lazy([held] { return *held; });
  EXPECT_EQ(held.use_count(), 2);
  const int* value = &lazy.get();
  EXPECT_EQ(held.use_count(), 1);
  const Lazy<int> moved = std::move(lazy);
  EXPECT_EQ(&moved.get(), value);
  EXPECT_EQ(moved.get(), 5);
}

TEST(Lazy, IsMadeAsTheFirstOneSays) {
  int said = 0;
  const Lazy<int, int> lazy([&](int threads) {
    said = threads;
    return 7;
  });
  EXPECT_EQ(lazy.get(3), 7);
  EXPECT_EQ(lazy.get(5), 7);
  EXPECT_EQ(said, 3);
}

TEST(Lazy, OfNothingIsAnEmptyValue) { EXPECT_EQ(Lazy<std::string>().get(), ""); }

}  // namespace
}  // namespace landmarkdb
