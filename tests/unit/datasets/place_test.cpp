#include "datasets/place.hpp"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

bool same_geometry(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.vertices == b.vertices && a.object == b.object;
}

// The vertices of one storey, from its floor up. Each storey begins with the object "floor".
std::vector<Eigen::Vector3f> storey(const Place& place, int floor) {
  const Eigen::Vector3f rise(0, 0, static_cast<float>(floor * place.floor_height_m));
  std::vector<Eigen::Vector3f> vertices;
  int current = -1;
  std::uint32_t last = std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < place.mesh.triangles.size(); ++i) {
    const std::uint32_t object = place.mesh.object[i];
    if (object != last && place.mesh.objects[object].name == "floor") ++current;
    last = object;
    if (current != floor) continue;
    for (const std::uint32_t corner : place.mesh.triangles[i]) {
      vertices.emplace_back(place.mesh.vertices[corner] - rise);
    }
  }
  return vertices;
}

class PlaceOfType : public ::testing::TestWithParam<PlaceType> {};

TEST_P(PlaceOfType, ComesOutTheSameForTheSameSeed) {
  const PlaceOptions options{.type = GetParam(), .seed = 4, .size = 0.6, .floors = 1};
  const Place a = make_place(options);
  const Place b = make_place(options);
  EXPECT_TRUE(same_geometry(a.mesh, b.mesh));
  ASSERT_EQ(a.stations.size(), b.stations.size());
  for (std::size_t i = 0; i < a.stations.size(); ++i) {
    EXPECT_EQ(a.stations[i].matrix(), b.stations[i].matrix());
  }
}

TEST_P(PlaceOfType, IsAnotherForAnotherSeed) {
  const Place a = make_place({.type = GetParam(), .seed = 4, .size = 0.6, .floors = 1});
  const Place b = make_place({.type = GetParam(), .seed = 5, .size = 0.6, .floors = 1});
  EXPECT_FALSE(same_geometry(a.mesh, b.mesh));
  EXPECT_NE(a.name, b.name);
}

TEST_P(PlaceOfType, HasEverythingAScannerNeeds) {
  const Place place = make_place({.type = GetParam(), .seed = 6, .floors = 1, .stations = 4});
  EXPECT_GT(place.mesh.triangles.size(), 2'000U);
  EXPECT_EQ(place.mesh.object.size(), place.mesh.triangles.size());
  EXPECT_FALSE(place.areas.empty());
  EXPECT_EQ(place.stations.size(), 4U);
  EXPECT_FALSE(place.landmarks.empty());
  EXPECT_TRUE(std::all_of(place.mesh.vertices.begin(),
                          place.mesh.vertices.end(),
                          [](const Eigen::Vector3f& p) { return p.allFinite(); }));
}

TEST_P(PlaceOfType, KeepsBelowItsCeiling) {
  constexpr double kSlab_m = 0.3;
  constexpr double kLetIn_m = 0.05;  // what hangs from a ceiling may be let into it
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Place place = make_place({.type = GetParam(), .seed = seed, .floors = 1, .stations = 1});
    for (const Eigen::Vector3f& p : place.mesh.vertices) {
      ASSERT_LT(p.z(), place.floor_height_m - kSlab_m + kLetIn_m) << "seed " << seed;
      ASSERT_GT(p.z(), -0.4) << "seed " << seed;
    }
  }
}

TEST_P(PlaceOfType, CanBeSmallAndLarge) {
  EXPECT_NO_THROW(make_place({.type = GetParam(), .seed = 2, .size = 0.4, .floors = 1}));
  EXPECT_NO_THROW(make_place({.type = GetParam(), .seed = 2, .size = 1.8, .floors = 1}));
}

INSTANTIATE_TEST_SUITE_P(All,
                         PlaceOfType,
                         ::testing::ValuesIn(all_place_types().begin(), all_place_types().end()),
                         [](const auto& type) { return std::string(place_type_name(type.param)); });

TEST(MakePlace, MakesExactCopiesThatDifferByATranslationOnly) {
  const Place place = make_place({.type = PlaceType::kCorridor,
                                  .seed = 3,
                                  .size = 0.5,
                                  .floors = 3,
                                  .copies = FloorCopies::kExact});
  const std::vector<Eigen::Vector3f> ground = storey(place, 0);
  ASSERT_GT(ground.size(), 1'000U);
  for (const int floor : {1, 2}) {
    const std::vector<Eigen::Vector3f> copy = storey(place, floor);
    ASSERT_EQ(copy.size(), ground.size());
    for (std::size_t i = 0; i < copy.size(); ++i) {
      ASSERT_LT((copy[i] - ground[i]).norm(), 1e-5) << "vertex " << i << " of floor " << floor;
    }
  }
}

TEST(MakePlace, MakesCopiesWithOneDifference) {
  const Place place = make_place({.type = PlaceType::kCorridor,
                                  .seed = 3,
                                  .size = 0.5,
                                  .floors = 2,
                                  .copies = FloorCopies::kOneDifference});
  const std::size_t ground = storey(place, 0).size();
  const std::size_t above = storey(place, 1).size();
  EXPECT_GT(above, ground);
  EXPECT_LT(above, ground + 2'000U);
}

TEST(MakePlace, MakesLookAlikesOfOneArchitecture) {
  const Place place =
      make_place({.type = PlaceType::kCorridor, .seed = 3, .size = 0.5, .floors = 2});
  const std::vector<Eigen::Vector3f> ground = storey(place, 0);
  const std::vector<Eigen::Vector3f> above = storey(place, 1);
  ASSERT_GT(std::min(ground.size(), above.size()), 200U);
  // The shell is built first, and is the same; what stands in it is not.
  for (std::size_t i = 0; i < 50; ++i) EXPECT_LT((ground[i] - above[i]).norm(), 1e-5);
  EXPECT_NE(ground.size(), above.size());
}

TEST(MakePlace, MovesOnlyClutterFromDayToDay) {
  PlaceOptions options{.type = PlaceType::kOffice, .seed = 8, .size = 0.7};
  const Place today = make_place(options);
  options.day = 1;
  const Place later = make_place(options);
  EXPECT_FALSE(same_geometry(today.mesh, later.mesh));
  std::size_t same = 0;
  const std::size_t n = std::min(today.mesh.vertices.size(), later.mesh.vertices.size());
  while (same < n && today.mesh.vertices[same] == later.mesh.vertices[same]) ++same;
  EXPECT_GT(same, n / 2);
}

TEST(MakePlace, RefusesOptionsOutOfRange) {
  EXPECT_THROW(make_place({.size = 0.0}), Error);
  EXPECT_THROW(make_place({.size = std::numeric_limits<double>::quiet_NaN()}), Error);
  EXPECT_THROW(make_place({.clutter = -1.0}), Error);
  EXPECT_THROW(make_place({.floors = 21}), Error);
  EXPECT_THROW(make_place({.stations = -1}), Error);
}

TEST(PlaceTypeFromName, NamesWhatThereIsWhenItKnowsNoSuchType) {
  EXPECT_EQ(place_type_from_name("temple"), PlaceType::kTemple);
  try {
    place_type_from_name("cathedral");
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("cathedral"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("lobby"));
  }
}

}  // namespace
}  // namespace landmarkdb::datasets
