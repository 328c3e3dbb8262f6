#include "engine/matching/filters.hpp"

#include <limits>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;

std::vector<std::uint32_t> queries_of(const std::vector<Correspondence>& pairs) {
  std::vector<std::uint32_t> result;
  for (const Correspondence& pair : pairs) result.push_back(pair.query);
  return result;
}

TEST(NearestPairs, TakesTheFirstOfEachRowThatHasOne) {
  const std::vector<DescriptorMatch> matches = {{7, 0.5F}, {1, 0.6F}, {}, {}, {2, 0.1F}, {}};
  const std::vector<Correspondence> pairs = nearest_pairs(matches, 2);
  EXPECT_THAT(queries_of(pairs), ElementsAre(0, 2));
  EXPECT_EQ(pairs[0].target, 7U);
  EXPECT_EQ(pairs[0].distance, 0.5F);
  EXPECT_EQ(pairs[1].target, 2U);
}

TEST(FilterRatio, KeepsWhatIsClearlyNearerThanTheSecond) {
  const std::vector<DescriptorMatch> matches = {
      {0, 0.69F}, {1, 1.0F}, {0, 0.71F}, {1, 1.0F}, {3, 0.0F}, {4, 0.2F}};
  EXPECT_THAT(queries_of(filter_ratio(matches, 2, 0.7)), ElementsAre(0, 2));
}

TEST(FilterRatio, DropsExactTiesWhateverTheRatio) {
  const std::vector<DescriptorMatch> matches = {{0, 0.5F}, {1, 0.5F}, {0, 0.0F}, {1, 0.0F}};
  EXPECT_TRUE(filter_ratio(matches, 2, 1.0).empty());
}

TEST(FilterRatio, KeepsAQueryWithoutARivalAndLeavesOutOneWithoutAMatch) {
  const std::vector<DescriptorMatch> matches = {{0, 0.5F}, {}, {}, {}};
  EXPECT_THAT(queries_of(filter_ratio(matches, 2, 0.7)), ElementsAre(0));
}

TEST(FilterRatio, LooksAtTheSecondOfManyNeighbours) {
  const std::vector<DescriptorMatch> matches = {{0, 0.5F}, {1, 0.6F}, {2, 5.0F}};
  EXPECT_TRUE(filter_ratio(matches, 3, 0.7).empty());
}

TEST(FilterRatio, HoldsTheNearestAgainstTheNearestThatStandsElsewhere) {
  const std::vector<Eigen::Vector3f> target = {{0, 0, 0}, {0.1F, 0, 0}, {5, 0, 0}};
  const std::vector<DescriptorMatch> matches = {{0, 0.5F}, {1, 0.51F}, {2, 0.9F}};
  EXPECT_TRUE(filter_ratio(matches, 3, 0.7).empty());
  EXPECT_THAT(queries_of(filter_ratio(matches, 3, 0.7, {target, 0.3})), ElementsAre(0));
  EXPECT_TRUE(filter_ratio(matches, 3, 0.7, {target, 0.05}).empty());
  // None stands apart: the last is nearer than the first rival could be.
  EXPECT_TRUE(filter_ratio(matches, 3, 0.5, {target, 10.0}).empty());
  EXPECT_THAT(queries_of(filter_ratio(matches, 3, 0.6, {target, 10.0})), ElementsAre(0));
  const std::vector<DescriptorMatch> last = {{0, 0.5F}, {1, 0.51F}, {}};
  EXPECT_THAT(queries_of(filter_ratio(last, 3, 0.7, {target, 0.3})), ElementsAre(0));
  EXPECT_THROW(filter_ratio(matches, 3, 0.7, {std::span(target).first(2), 0.3}), Error);
}

TEST(FilterRatio, RefusesRowsAndRatiosThatCannotBe) {
  const std::vector<DescriptorMatch> matches(4);
  EXPECT_THROW(filter_ratio(matches, 1, 0.7), Error);
  EXPECT_THROW(filter_ratio(matches, 0, 0.7), Error);
  EXPECT_THROW(filter_ratio(matches, 3, 0.7), Error);
  EXPECT_THROW(filter_ratio(matches, 2, 0.0), Error);
  EXPECT_THROW(filter_ratio(matches, 2, 1.1), Error);
  EXPECT_THROW(filter_ratio(matches, 2, std::numeric_limits<double>::quiet_NaN()), Error);
  EXPECT_TRUE(filter_ratio({}, 2, 0.7).empty());
}

TEST(FilterMutual, KeepsPairsThatAreEachOthersNearest) {
  const std::vector<DescriptorMatch> matches = {{1, 0.1F}, {}, {0, 0.2F}, {1, 0.3F}, {1, 0.4F}, {}};
  const std::vector<DescriptorMatch> reverse = {{2, 0.4F}, {0, 0.1F}};
  const std::vector<Correspondence> kept = filter_mutual(matches, 2, reverse, 1);
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0].query, 0U);
  EXPECT_EQ(kept[0].target, 1U);
  EXPECT_THROW(filter_mutual(matches, 2, std::span(reverse).first(1), 1), Error);
  EXPECT_THROW(filter_mutual(matches, 2, reverse, 3), Error);
}

}  // namespace
}  // namespace landmarkdb
