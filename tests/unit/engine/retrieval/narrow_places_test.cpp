#include "engine/retrieval/narrow_places.hpp"

#include <initializer_list>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

auto Near(double value) { return ::testing::DoubleNear(value, 1e-12); }

std::vector<std::size_t> best_of(std::initializer_list<std::pair<std::size_t, double>> standings,
                                 std::size_t most) {
  std::vector<PlaceScore> scores;
  for (const auto& [entry, standing] : standings) scores.push_back({entry, 0.0, standing});
  return best_places(scores, most);
}

std::vector<double> standings_of(std::initializer_list<double> scores) {
  std::vector<PlaceScore> places;
  for (const double score : scores) places.push_back({places.size(), score, -1.0});
  set_standings(places);
  std::vector<double> standings;
  for (const PlaceScore& place : places) standings.push_back(place.standing);
  return standings;
}

TEST(BestPlaces, KeepsTheHighestInTheirOrderAndTheFirstOfTwoAlike) {
  EXPECT_THAT(best_of({}, 3), IsEmpty());
  EXPECT_THAT(best_of({{7, 0.39}, {9, 0.4}}, 3), ElementsAre(7, 9));
  EXPECT_THAT(best_of({{3, 0.36}, {4, 0.4}, {8, 0.37}, {9, 0.4}}, 2), ElementsAre(4, 9));
  EXPECT_THAT(best_of({{3, 0.4}, {4, 0.4}, {8, 0.37}, {9, 0.4}}, 2), ElementsAre(3, 4));
  EXPECT_THAT(best_of({{3, 0.0}, {4, 0.0}, {5, 0.0}}, 2), ElementsAre(3, 4));
}

TEST(BestPlaces, DropsWhatIsFarBehindTheHighest) {
  EXPECT_THAT(best_of({{3, 0.8}, {4, 0.47}, {5, 0.49}}, 3), ElementsAre(3, 5));
  EXPECT_THAT(best_of({{3, 0.0}, {4, 0.5}, {5, -0.2}}, 3), ElementsAre(4));
}

TEST(SetStandings, IsTheShareOfWhatTheLowerQuartileLeaves) {
  EXPECT_THAT(standings_of({0.25, 0.625, 0.0, 0.25}), ElementsAre(0.0, 0.5, Near(-1.0 / 3.0), 0.0));
  EXPECT_THAT(standings_of({0.5, 0.75}), ElementsAre(0.0, 0.5));
  EXPECT_THAT(standings_of({1.0, 1.0, 1.0}), ElementsAre(0.0, 0.0, 0.0));
  EXPECT_THAT(standings_of({}), IsEmpty());
}

TEST(SetStandings, ManyAlikeStandOutTogether) {
  EXPECT_THAT(standings_of({0.8, 0.8, 0.2, 0.8, 0.2, 0.8}),
              ElementsAre(Near(0.75), Near(0.75), 0.0, Near(0.75), 0.0, Near(0.75)));
}

// 0.6 on a grid where a wrong place has 0.5 says less than 0.4 where it has 0.1.
TEST(SetStandings, LevelsCompareByIt) {
  std::vector<PlaceScore> coarse{{1, 0.5, 0.0}, {2, 0.5, 0.0}, {3, 0.6, 0.0}};
  std::vector<PlaceScore> fine{{4, 0.4, 0.0}, {5, 0.1, 0.0}, {6, 0.1, 0.0}};
  set_standings(coarse);
  set_standings(fine);
  coarse.insert(coarse.end(), fine.begin(), fine.end());
  EXPECT_THAT(best_places(coarse, 3), ElementsAre(4));
}

}  // namespace
}  // namespace landmarkdb
