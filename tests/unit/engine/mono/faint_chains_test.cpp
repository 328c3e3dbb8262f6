#include "engine/mono/faint_chains.hpp"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

EdgePoint point(double u, double v) {
  return {{static_cast<float>(u), static_cast<float>(v)}, {0.0F, -1.0F}};
}

// A chain of other points, and `points` after it as the last one.
EdgeChains after_another(const std::vector<EdgePoint>& points) {
  EdgeChains chains;
  for (int i = 0; i < 15; ++i) chains.points.push_back(point(i, 100.0));
  chains.chains.push_back({0, 15, true});
  chains.points.insert(chains.points.end(), points.begin(), points.end());
  chains.chains.push_back({15, static_cast<std::uint32_t>(chains.points.size()), false});
  return chains;
}

void expect_first_untouched(const EdgeChains& chains) {
  ASSERT_FALSE(chains.chains.empty());
  EXPECT_EQ(chains.chains[0].begin, 0U);
  EXPECT_EQ(chains.chains[0].end, 15U);
  EXPECT_TRUE(chains.chains[0].closed);
  for (int i = 0; i < 15; ++i) EXPECT_EQ(chains.points[static_cast<std::size_t>(i)].uv.x(), i);
}

TEST(KeepStraightRuns, KeepsAStraightChainWhole) {
  std::vector<EdgePoint> line;
  for (int i = 0; i < 30; ++i) line.push_back(point(i, 20.0 + 0.4 * (i % 3 - 1)));
  EdgeChains chains = after_another(line);
  ChainSplitter splitter;
  keep_straight_runs(chains, splitter);
  expect_first_untouched(chains);
  ASSERT_EQ(chains.chains.size(), 2U);
  EXPECT_EQ(chains.chains[1].begin, 15U);
  EXPECT_EQ(chains.chains[1].end, 45U);
  EXPECT_EQ(chains.points.size(), 45U);
}

TEST(KeepStraightRuns, KeepsACornerOfTwoSidesInOneChain) {
  std::vector<EdgePoint> corner;
  for (int i = 0; i < 20; ++i) corner.push_back(point(i, 0.0));
  for (int i = 0; i < 20; ++i) corner.push_back(point(20.0, i));
  EdgeChains chains = after_another(corner);
  ChainSplitter splitter;
  keep_straight_runs(chains, splitter);
  ASSERT_EQ(chains.chains.size(), 2U);
  EXPECT_EQ(chains.chains[1].end - chains.chains[1].begin, 40U) << "each point once";
}

TEST(KeepStraightRuns, DropsAWavyChainAndLeavesTheOthers) {
  std::vector<EdgePoint> wave;
  for (int i = 0; i < 60; ++i) wave.push_back(point(i, 3.0 * std::sin(0.4 * i)));
  EdgeChains chains = after_another(wave);
  ChainSplitter splitter;
  keep_straight_runs(chains, splitter);
  expect_first_untouched(chains);
  EXPECT_EQ(chains.chains.size(), 1U);
  EXPECT_EQ(chains.points.size(), 15U);
}

TEST(KeepStraightRuns, KeepsWhatIsStraightOnBothSidesOfABend) {
  std::vector<EdgePoint> points;
  for (int i = 0; i < 20; ++i) points.push_back(point(i, 0.0));
  for (int i = 1; i < 8; ++i) points.push_back(point(20.0 + 4.0 * (i % 2), 2.0 * i));
  for (int i = 0; i < 20; ++i) points.push_back(point(20.0 + i, 16.0));
  EdgeChains chains = after_another(points);
  ChainSplitter splitter;
  keep_straight_runs(chains, splitter);
  ASSERT_EQ(chains.chains.size(), 3U);
  EXPECT_EQ(chains.chains[2].begin, chains.chains[1].end);
  EXPECT_EQ(chains.chains[2].end, chains.points.size());
  EXPECT_EQ(chains.points.back().uv.x(), 39.0F);
  for (std::size_t i = 15; i < chains.points.size(); ++i) {
    const float v = chains.points[i].uv.y();
    EXPECT_TRUE(v < 3.0F || v > 13.0F) << v;
  }
}

}  // namespace
}  // namespace landmarkdb
