#include "client/choices.hpp"

#include <gmock/gmock.h>

#include "cli/usage_error.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::ElementsAre;

TEST(Choices, TurnWordsIntoEnumeratorsAndBack) {
  EXPECT_EQ(keypoint_method("uniform", "--keypoints"), KeypointMethod::kUniform);
  EXPECT_EQ(keypoint_method("narf", "--keypoints"), KeypointMethod::kNarf);
  for (const std::string& name : kKeypointNames) {
    EXPECT_EQ(name_of(keypoint_method(name, "--keypoints")), name);
  }
  EXPECT_EQ(measure("chi2", "--measure"), Measure::kChi2);
  EXPECT_EQ(measure("bhattacharyya", "--measure"), Measure::kBhattacharyya);
  EXPECT_EQ(name_of(EntryKind::kObject), "object");
}

TEST(Filters, ReadAListInItsOrder) {
  EXPECT_THAT(filters("clique,ratio", "--filters"), ElementsAre(Filter::kClique, Filter::kRatio));
  EXPECT_THAT(filters("slope", "--filters"), ElementsAre(Filter::kSlope));
}

TEST(Filters, RefuseUnknownRepeatedAndEmptyWords) {
  EXPECT_THROW(filters("ratio,slop", "--filters"), cli::UsageError);
  EXPECT_THROW(filters("ratio,ratio", "--filters"), cli::UsageError);
  EXPECT_THROW(filters("ratio,", "--filters"), cli::UsageError);
  EXPECT_THROW(measure("cosine", "--measure"), cli::UsageError);
}

}  // namespace
}  // namespace landmarkdb::client
