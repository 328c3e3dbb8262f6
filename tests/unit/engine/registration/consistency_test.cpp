#include "engine/registration/consistency.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

struct Task {
  std::vector<Eigen::Vector3f> target, source;
  std::vector<Correspondence> pairs;
  std::vector<bool> planted;
};

// `right` pairs that one motion explains and `wrong` ones at random, in random order.
Task plant(std::uint64_t seed, std::uint32_t right, std::uint32_t wrong, double noise_m = 0.0) {
  Random random(seed);
  const Eigen::Isometry3d T = testing::random_pose(random, 3.0, 5.0);
  const auto draw = [&](double size) {
    return Eigen::Vector3d(
        random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size));
  };
  Task task;
  task.planted.assign(right + wrong, false);
  for (std::uint32_t i = 0; i < right; ++i) {
    std::size_t place = random.below(right + wrong);
    while (task.planted[place]) place = random.below(right + wrong);
    task.planted[place] = true;
  }
  for (std::uint32_t i = 0; i < right + wrong; ++i) {
    const Eigen::Vector3d here = draw(4.0);
    const Eigen::Vector3d there = task.planted[i] ? T * here + draw(noise_m) : draw(8.0);
    task.source.push_back(here.cast<float>());
    task.target.push_back(there.cast<float>());
    task.pairs.push_back({i, i, static_cast<float>(random.uniform())});
  }
  return task;
}

std::vector<Correspondence> filter(const Task& task, const ConsistencyOptions& options = {}) {
  return filter_consistency(task.pairs, task.target, task.source, options);
}

TEST(FilterConsistency, FindsTheCliqueAmongOutliers) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Task task = plant(seed, 20, 180, 0.01);
    const std::vector<Correspondence> kept = filter(task);
    std::size_t right = 0;
    for (const Correspondence& pair : kept) right += task.planted[pair.query] ? 1 : 0;
    EXPECT_GE(right, 17U) << seed;
    EXPECT_LE(kept.size() - right, 3U) << seed;
  }
}

TEST(FilterConsistency, KeepsTheOrderItWasGiven) {
  const std::vector<Correspondence> kept = filter(plant(1, 30, 100));
  ASSERT_GE(kept.size(), 25U);
  EXPECT_TRUE(std::is_sorted(
      kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.query < b.query; }));
}

TEST(FilterConsistency, RepeatsAndBreaksTiesByOrder) {
  // Two cliques of four, far from agreeing with each other: the first given wins, always.
  Task task = plant(3, 4, 0);
  const Task other = plant(4, 4, 0);
  for (std::uint32_t i = 0; i < 4; ++i) {
    task.source.push_back(other.source[i]);
    task.target.push_back(other.target[i] + Eigen::Vector3f(300, 0, 0));
    task.pairs.push_back({4 + i, 4 + i, 0.0F});
  }
  for (int round = 0; round < 3; ++round) {
    const std::vector<Correspondence> kept = filter(task);
    ASSERT_EQ(kept.size(), 4U);
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(kept[i].query, i);
  }
}

TEST(FilterConsistency, KeepsOnlyPairsThatAllAgree) {
  const Task task = plant(5, 15, 300, 0.02);
  const ConsistencyOptions options;
  const std::vector<Correspondence> kept = filter(task, options);
  for (const Correspondence& a : kept) {
    for (const Correspondence& b : kept) {
      if (a.query == b.query) continue;
      const float there = (task.target[a.target] - task.target[b.target]).norm();
      const float here = (task.source[a.query] - task.source[b.query]).norm();
      EXPECT_LE(std::abs(there - here), options.tolerance_m);
      EXPECT_GE(here, options.min_separation_m);
    }
  }
}

TEST(FilterConsistency, CountsNeighboursThatAgreeByBeingCloseForNothing) {
  // Fifty pairs in one spot each: every distance is about zero on both sides.
  Task task;
  Random random(6);
  for (std::uint32_t i = 0; i < 50; ++i) {
    task.source.emplace_back(static_cast<float>(random.uniform(0.0, 0.05)), 0.0F, 0.0F);
    task.target.emplace_back(0.0F, static_cast<float>(random.uniform(0.0, 0.05)), 7.0F);
    task.pairs.push_back({i, i, 0.0F});
  }
  EXPECT_TRUE(filter(task).empty());
}

TEST(FilterConsistency, HasNothingWhenFewerThanThreeAgree) {
  EXPECT_TRUE(filter(Task{}).empty());
  EXPECT_TRUE(filter(plant(7, 1, 0)).empty());
  EXPECT_TRUE(filter(plant(7, 2, 0)).empty());
  EXPECT_EQ(filter(plant(7, 3, 0)).size(), 3U);
}

TEST(FilterConsistency, LooksAtTheBestByDescriptorWhenThereAreTooMany) {
  Task task = plant(8, 10, 60);
  for (std::size_t i = 0; i < task.pairs.size(); ++i) {
    task.pairs[i].distance = task.planted[i] ? 0.1F : 0.5F;
  }
  ConsistencyOptions options;
  options.max_pairs = 10;
  const std::vector<Correspondence> kept = filter(task, options);
  EXPECT_GE(kept.size(), 8U);
  for (const Correspondence& pair : kept) EXPECT_TRUE(task.planted[pair.query]);
  for (std::size_t i = 0; i < task.pairs.size(); ++i) {
    task.pairs[i].distance = task.planted[i] ? 0.5F : 0.1F;  // now the wrong ones look best
  }
  for (const Correspondence& pair : filter(task, options)) EXPECT_FALSE(task.planted[pair.query]);
}

}  // namespace
}  // namespace landmarkdb
