#include "datasets/stations.hpp"

#include <gtest/gtest.h>

#include "datasets/sensor_poses.hpp"

namespace landmarkdb::datasets {
namespace {

TEST(ChooseStations, StandFreeAndApart) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .stations = 4});
  const auto stations = choose_stations(place);
  ASSERT_EQ(stations.size(), 4U);
  for (std::size_t i = 0; i < stations.size(); ++i) {
    EXPECT_TRUE(is_free(*place.caster, stations[i].translation(), 0.4));
    for (std::size_t k = 0; k < i; ++k) {
      EXPECT_GT((stations[i].translation() - stations[k].translation()).norm(), 1.5);
    }
  }
}

TEST(ChooseStations, AreTheSameOnStoreysThatAreCopies) {
  const Place place = make_place({.type = PlaceType::kCorridor,
                                  .seed = 2,
                                  .size = 0.5,
                                  .floors = 2,
                                  .copies = FloorCopies::kExact,
                                  .stations = 3});
  ASSERT_EQ(place.stations.size(), 6U);
  const Eigen::Vector3d rise(0, 0, place.floor_height_m);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((place.stations[i].translation() + rise - place.stations[i + 3].translation()).norm(),
              1e-6);
  }
}

}  // namespace
}  // namespace landmarkdb::datasets
