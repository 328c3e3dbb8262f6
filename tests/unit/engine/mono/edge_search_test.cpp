#include "engine/mono/edge_search.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/engine/mono/paint.hpp"

namespace landmarkdb {
namespace {

// Dark left of a slanted line through (40 + shift, 40), bright right of it.
GreyImage slanted(double shift) {
  return testing::paint(80, 80, [shift](double u, double v) {
    return u - 40.0 - shift + 0.2 * (v - 40.0) < 0.0 ? 40.0 : 180.0;
  });
}

TrackSample across_slant() {
  TrackSample sample;
  sample.uv = {40.0, 40.0};
  sample.normal = Eigen::Vector2d(1.0, 0.2).normalized();
  return sample;
}

TEST(SearchImageEdges, FindsAnEdgeToAFractionOfAPixel) {
  for (const double shift : {-7.3, -0.4, 0.0, 2.5, 11.7}) {
    const std::vector<TrackSample> samples = {across_slant()};
    const EdgeCandidates found = search_image_edges(slanted(shift), samples, EdgeMemory(1), {});
    ASSERT_EQ(found.of(0).size(), 1U) << shift;
    EXPECT_NEAR(found.of(0)[0].offset_px, shift / std::hypot(1.0, 0.2), 0.15) << shift;
    EXPECT_GT(found.of(0)[0].strength, 20.0F);
    EXPECT_GT(found.of(0)[0].cosine, 0.97F);
  }
}

TEST(SearchImageEdges, LeavesOutEdgesThatRunAnotherWayAndThoseOutOfReach) {
  TrackSample along = across_slant();
  along.normal = Eigen::Vector2d(0.2, 1.0).normalized();
  along.uv = {40.0, 30.0};
  const std::vector<TrackSample> samples = {along, across_slant()};
  const EdgeCandidates found =
      search_image_edges(slanted(12.0), samples, EdgeMemory(1), {.reach_px = 8.0});
  EXPECT_TRUE(found.of(0).empty());
  EXPECT_TRUE(found.of(1).empty());
}

TEST(SearchImageEdges, TellsEdgesApartByWhatTheyLookedLikeBefore) {
  // Two edges of opposite sense; the sample's was the one that gets brighter.
  const auto stripe = [](double shift) {
    return testing::paint(80, 80, [shift](double u, double) {
      return u < 36.0 + shift ? 60.0 : u < 46.0 + shift ? 160.0 : 90.0;
    });
  };
  TrackSample sample;
  sample.uv = {36.0, 40.0};
  sample.normal = {1.0, 0.0};
  EdgeMemory memory(1);
  memory.remember(sample, look_at_edge(stripe(0.0), sample, 0.0));
  const std::vector<TrackSample> samples = {sample};
  const EdgeCandidates without = search_image_edges(stripe(-6.0), samples, EdgeMemory(1), {});
  const EdgeCandidates with = search_image_edges(stripe(-6.0), samples, memory, {});
  EXPECT_EQ(without.of(0).size(), 2U);
  ASSERT_EQ(with.of(0).size(), 1U);
  EXPECT_NEAR(with.of(0)[0].offset_px, -6.0, 0.2);
  EXPECT_LT(with.of(0)[0].unlike_px, 1.0F);
}

TEST(SearchImageEdges, StaysInsideTheImageAtItsBorder) {
  TrackSample corner;
  corner.uv = {1.0, 78.5};
  corner.normal = Eigen::Vector2d(1.0, 1.0).normalized();
  const std::vector<TrackSample> samples = {corner};
  EXPECT_TRUE(search_image_edges(slanted(0.0), samples, EdgeMemory(1), {}).of(0).empty());
}

TEST(SearchEdgePoints, FindsThePointsOnTheSearchLineOnly) {
  std::vector<EdgePoint> edges;
  const Eigen::Vector2f normal = Eigen::Vector2f(1.0F, 0.2F).normalized();
  for (int v = 0; v < 80; ++v) {
    edges.push_back(
        {{43.0F - 0.2F * (static_cast<float>(v) - 40.0F), static_cast<float>(v)}, -normal});
    edges.push_back({{static_cast<float>(v), 60.0F}, {0.0F, 1.0F}});
  }
  const std::vector<TrackSample> samples = {across_slant()};
  const EdgeCandidates found = search_edge_points(edges, samples, {});
  ASSERT_FALSE(found.of(0).empty());
  for (const EdgeCandidate& candidate : found.of(0)) {
    EXPECT_NEAR(candidate.offset_px, 3.0 / std::hypot(1.0, 0.2), 0.05);
    EXPECT_LT(candidate.strength, 0.0F);
  }
  EXPECT_TRUE(search_edge_points(edges, samples, {.reach_px = 2.0}).of(0).empty());
  EXPECT_TRUE(search_edge_points({}, samples, {}).of(0).empty());
}

}  // namespace
}  // namespace landmarkdb
