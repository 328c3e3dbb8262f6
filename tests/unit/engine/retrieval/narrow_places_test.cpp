#include "engine/retrieval/narrow_places.hpp"

#include <gmock/gmock.h>

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::size_t> best_of(const std::vector<PlaceScore>& scores, std::size_t most) {
  return best_places(scores, most);
}

TEST(BestPlaces, KeepsTheBestInTheirOrderAndTheFirstOfTwoAlike) {
  EXPECT_THAT(best_of({}, 3), IsEmpty());
  EXPECT_THAT(best_of({{7, 0.39}, {9, 0.4}}, 3), ElementsAre(7, 9));
  EXPECT_THAT(best_of({{3, 0.36}, {4, 0.4}, {8, 0.37}, {9, 0.4}}, 2), ElementsAre(4, 9));
  EXPECT_THAT(best_of({{3, 0.4}, {4, 0.4}, {8, 0.37}, {9, 0.4}}, 2), ElementsAre(3, 4));
  EXPECT_THAT(best_of({{3, 0.3}, {4, 0.3}, {5, 0.3}}, 2), ElementsAre(3, 4));
}

TEST(BestPlaces, DropsWhatIsFarBehindTheBest) {
  EXPECT_THAT(best_of({{3, 0.8}, {4, 0.71}, {5, 0.73}}, 3), ElementsAre(3, 5));
  EXPECT_THAT(best_of({{3, 0.0}, {4, 0.5}}, 3), ElementsAre(4));
}

}  // namespace
}  // namespace landmarkdb
