#include "engine/retrieval/narrow_places.hpp"

#include <gmock/gmock.h>

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(BestPlaces, KeepsTheBestInTheirOrderAndTheFirstOfTwoAlike) {
  EXPECT_THAT(best_places(std::vector<double>{}, 3), IsEmpty());
  EXPECT_THAT(best_places(std::vector<double>{0.1, 0.2}, 3), ElementsAre(0, 1));
  EXPECT_THAT(best_places(std::vector<double>{0.1, 0.4, 0.3, 0.4}, 2), ElementsAre(1, 3));
  EXPECT_THAT(best_places(std::vector<double>{0.3, 0.3, 0.3}, 2), ElementsAre(0, 1));
}

}  // namespace
}  // namespace landmarkdb
