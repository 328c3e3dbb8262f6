#include <array>
#include <limits>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "tests/unit/engine/matching/histograms.hpp"

namespace landmarkdb {
namespace {

using testing::random_descriptors;

constexpr std::array kAll = {Measure::kL2,
                             Measure::kL1,
                             Measure::kChi2,
                             Measure::kIntersection,
                             Measure::kCorrelation,
                             Measure::kBhattacharyya};

TEST(FlannIndex, AgreesWithTheExactIndexForEveryMeasure) {
  const std::vector<float> stored = random_descriptors(400, 10, 1);
  const std::vector<float> queries = random_descriptors(25, 10, 1);
  for (const Measure measure : kAll) {
    std::vector<DescriptorMatch> exact;
    std::vector<DescriptorMatch> flann;
    make_exact_index(stored, measure)->search(queries, 4, exact, {});
    make_flann_index(stored, measure)->search(queries, 4, flann, {});
    EXPECT_EQ(flann, exact) << static_cast<int>(measure);
  }
}

TEST(FlannIndex, RepeatsFromBuildToBuildAndForAnyThreadCount) {
  const std::vector<float> stored = random_descriptors(500, 10, 2);
  const std::vector<float> queries = random_descriptors(70, 10, 2);
  RunContext three;
  three.threads = 3;
  for (const float epsilon : {0.0F, 1.0F}) {
    std::vector<DescriptorMatch> first;
    std::vector<DescriptorMatch> second;
    make_flann_index(stored, Measure::kL2, epsilon)->search(queries, 3, first, {});
    make_flann_index(stored, Measure::kL2, epsilon)->search(queries, 3, second, three);
    EXPECT_EQ(first, second);
  }
}

TEST(FlannIndex, KeepsItsPromiseWhenApproximate) {
  const std::vector<float> stored = random_descriptors(500, 20, 3);
  const std::vector<float> queries = random_descriptors(40, 20, 4);
  constexpr float kEpsilon = 0.5F;
  std::vector<DescriptorMatch> exact;
  std::vector<DescriptorMatch> approximate;
  make_exact_index(stored, Measure::kL1)->search(queries, 1, exact, {});
  make_flann_index(stored, Measure::kL1, kEpsilon)->search(queries, 1, approximate, {});
  for (std::size_t i = 0; i < exact.size(); ++i) {
    EXPECT_LE(approximate[i].distance, (1.0F + kEpsilon) * exact[i].distance + 1e-6F);
  }
}

TEST(FlannIndex, SaysWhereAnIndexHoldsFewerThanAsked) {
  const std::vector<float> stored = random_descriptors(2, 2, 4);
  std::vector<DescriptorMatch> found;
  make_flann_index(stored, Measure::kL2)->search(stored, 4, found, {});
  ASSERT_EQ(found.size(), 8U);
  EXPECT_EQ(found[4].index, 1U);
  EXPECT_EQ(found[5].index, 0U);
  EXPECT_EQ(found[6], DescriptorMatch{});
  make_flann_index({}, Measure::kChi2)->search(stored, 3, found, {});
  EXPECT_EQ(found, std::vector<DescriptorMatch>(6));
  make_flann_index(stored, Measure::kL1)->search({}, 3, found, {});
  EXPECT_TRUE(found.empty());
}

TEST(FlannIndex, TakesDescriptorsThatAreAllTheSame) {
  const std::vector<float> one = random_descriptors(1, 1, 5);
  std::vector<float> stored;
  for (int i = 0; i < 100; ++i) stored.insert(stored.end(), one.begin(), one.end());
  std::vector<DescriptorMatch> found;
  make_flann_index(stored, Measure::kChi2)->search(one, 5, found, {});
  for (const DescriptorMatch& match : found) EXPECT_EQ(match.distance, 0.0F);
}

TEST(FlannIndex, RefusesBrokenRowsAndStopsWhenAsked) {
  std::vector<float> values = random_descriptors(2, 2, 6);
  const auto index = make_flann_index(values, Measure::kL2);
  EXPECT_EQ(index->size(), 2U);
  std::vector<DescriptorMatch> found;
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_THROW(index->search(values, 1, found, context), Error);
  EXPECT_THROW(make_flann_index(values, Measure::kL2, -1.0F), Error);
  EXPECT_THROW(make_flann_index(std::span(values).first(10), Measure::kL2), Error);
  values[3] = std::numeric_limits<float>::infinity();
  EXPECT_THROW(index->search(values, 1, found, {}), Error);
  EXPECT_THROW(make_flann_index(values, Measure::kL2), Error);
}

}  // namespace
}  // namespace landmarkdb
