#include "engine/mono/visibility.hpp"

#include <algorithm>
#include <cmath>

#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using testing::box_json;
using testing::read_text;

std::size_t count(const std::vector<bool>& seen) {
  return static_cast<std::size_t>(std::count(seen.begin(), seen.end(), true));
}

TEST(Visibility, ViewsCoverTheSphereEvenly) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& view : model_views()) {
    EXPECT_NEAR(view.norm(), 1.0, 1e-12);
    sum += view;
    double nearest = 2.0;
    for (const Eigen::Vector3d& other : model_views()) {
      if (&other != &view) nearest = std::min(nearest, (other - view).norm());
    }
    EXPECT_GT(nearest, 0.15);  // of 0.22, the side of a square of a 256th of the sphere
    EXPECT_LT(nearest, 0.27);
  }
  EXPECT_LT(sum.norm() / kModelViews, 1e-3);
}

TEST(Visibility, ABoxShowsSevenCornersAndThreeFaceCentres) {
  const ModelVisibility box(read_text(box_json(), "box.json").model);
  const std::vector<bool> seen = box.points_along(Eigen::Vector3d(1, 2, 1.5).normalized());
  EXPECT_EQ(count(seen), 7U + 3U);
  EXPECT_FALSE(seen[0]);  // the corner at the back
  EXPECT_EQ(box.points_from({0.5, 1.0, 0.75}), seen);
}

TEST(Visibility, FromNearbyFewerFacesAreSeenThanFromAfar) {
  const ModelVisibility box(read_text(box_json(), "box.json").model);
  const Eigen::Vector3d above(0.06, 0.04, 0.2);
  EXPECT_EQ(count(box.points_from(above)), 4U + 1U);
  EXPECT_TRUE(box.face_turned_to(1, above));
  EXPECT_FALSE(box.face_turned_to(3, above));
  EXPECT_TRUE(box.face_turned_to(3, {0.2, 0.04, 0.03}));
}

TEST(Visibility, FacesInFrontHide) {
  // A small tile floating above a large one, both sheets.
  const MonoModel model =
      read_text(
          R"({"points": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0],[-0.2,-0.2,1],[0.2,-0.2,1],[0.2,0.2,1],
          [-0.2,0.2,1],[0,0,0.1]], "faces": [[0,1,2,3],[4,5,6,7]]})",
          "tiles.json")
          .model;
  const ModelVisibility tiles(model);
  const std::vector<bool> above = tiles.points_along(Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(above[8]);  // under the small tile
  EXPECT_FALSE(above[9]);  // so is the large one's centre
  EXPECT_TRUE(above[10]);
  const std::vector<bool> below = tiles.points_along(-Eigen::Vector3d::UnitZ());
  EXPECT_FALSE(below[4]);  // sheets hide from both sides,
  EXPECT_TRUE(below[0]);   // and are seen from both
  EXPECT_TRUE(below[9]);
  // A camera between the tiles has nothing in the way.
  EXPECT_TRUE(tiles.points_from({0, 0, 0.5})[8]);
  EXPECT_TRUE(tiles.place_seen_from({0.1, 0, 0}, {0, 0, 0.5}));
  EXPECT_FALSE(tiles.place_seen_from({0.1, 0, 0}, {0, 0, 5}));
}

// A box, a stair (faces hide its own edges) and two sheets, along their edges from all around.
TEST(PlaceSight, SeesWhatTheVisibilitySays) {
  const std::vector<MonoModel> models{
      read_text(box_json(), "box.json").model,
      read_text(R"({"points": [[0,0,0],[2,0,0],[2,1,0],[1,1,0],[1,2,0],[0,2,0],
          [0,0,1],[2,0,1],[2,1,1],[1,1,1],[1,2,1],[0,2,1]],
          "faces": [[5,4,3,2,1,0],[6,7,8,9,10,11],[0,1,7,6],[1,2,8,7],[2,3,9,8],[3,4,10,9],
          [4,5,11,10],[5,0,6,11]]})",
                "stair.json")
          .model,
      read_text(R"({"points": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0],[-0.2,-0.2,1],[0.2,-0.2,1],
          [0.2,0.2,1],[-0.2,0.2,1]], "faces": [[0,1,2,3],[4,5,6,7]]})",
                "tiles.json")
          .model};
  for (const MonoModel& model : models) {
    const ModelVisibility visibility(model);
    int asked = 0, other = 0, hidden = 0;
    for (const Eigen::Vector3d& view : model_views()) {
      const Eigen::Vector3d eye = model.points[0].xyz + 6.0 * model.diameter_m * view;
      const PlaceSight sight(visibility, eye);
      for (const auto& [a, b] : model.edges) {
        for (const double at : {0.13, 0.5, 0.87}) {
          const Eigen::Vector3d place = (1.0 - at) * model.points[a].xyz + at * model.points[b].xyz;
          const bool seen = visibility.place_seen_from(place, eye);
          ++asked;
          hidden += seen ? 0 : 1;
          other += sight.sees(place) == seen ? 0 : 1;
        }
      }
    }
    EXPECT_GT(asked, 1000);
    EXPECT_LE(other, asked / 500) << model.name << ": " << hidden << " hidden of " << asked;
  }
}

TEST(Visibility, ANormalIsSeenToALittlePastTheHorizon) {
  const ModelVisibility model(read_text(R"({"points": [{"xyz":[0,0,0],"normal":[0,0,1]},
      [0.1,0,0],[0,0.1,0],[0,0,0.1]]})",
                                        "a.json")
                                  .model);
  const auto at = [&](double degrees) -> bool {
    const double rad = degrees * 3.14159265358979 / 180.0;
    return model.points_along({std::sin(rad), 0.0, std::cos(rad)})[0];
  };
  EXPECT_TRUE(at(0));
  EXPECT_TRUE(at(100));
  EXPECT_FALSE(at(103));
  EXPECT_FALSE(at(180));
}

TEST(Visibility, PatternsAreSeenFromBothSides) {
  const MonoModel board =
      read_text(R"({"points": [[0,0,0],[0.1,0,0],[0.1,0.1,0],[0,0.1,0]], "faces": [[0,1,2,3]]})",
                "board.json")
          .model;
  EXPECT_TRUE(is_flat(board));
  EXPECT_FALSE(is_flat(read_text(box_json(), "box.json").model));
  EXPECT_EQ(count(ModelVisibility(board).points_along({0, 0, 1})), 5U);
  EXPECT_EQ(count(ModelVisibility(board).points_along({0, 0, -1})), 5U);
}

TEST(Visibility, TellsSolidsFromSheets) {
  const MonoModel box = read_text(box_json(), "box.json").model;
  EXPECT_EQ(count(solid_faces(box)), 6U);
  MonoModel open = box;
  open.faces.pop_back();
  EXPECT_EQ(count(solid_faces(open)), 0U);
}

}  // namespace
}  // namespace landmarkdb
