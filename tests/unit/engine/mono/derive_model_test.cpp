#include "engine/mono/derive_model.hpp"

#include "engine/mono/model_faces.hpp"
#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using testing::box_json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kBoxPoints;
using testing::read_text;
using testing::refusal_of;
using ::testing::SizeIs;

void expect_outward(const MonoModel& model) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const auto& p : model.points) centre += p.xyz / static_cast<double>(model.points.size());
  for (const auto& face : model.faces) {
    EXPECT_GT(area_vector(model, face).dot(model.points[face[0]].xyz - centre), 0.0);
  }
}

TEST(DeriveModel, TakesEdgesFromFaces) {
  const auto read = read_text(box_json(), "box.json");
  EXPECT_THAT(read.warnings, IsEmpty());
  EXPECT_THAT(read.model.edges, SizeIs(12));
  EXPECT_THAT(read.model.edges, Contains(ElementsAre(2, 6)));
  EXPECT_TRUE(std::is_sorted(read.model.edges.begin(), read.model.edges.end()));
}

TEST(DeriveModel, KeepsListedEdgesOnceEach) {
  const auto read = read_text(box_json(R"(, "edges": [[1,0],[0,1],[6,2]])"), "box.json");
  EXPECT_THAT(read.model.edges, ElementsAre(ElementsAre(0, 1), ElementsAre(2, 6)));
}

TEST(DeriveModel, AddsTypedPointsBehindTheListedOnes) {
  const MonoModel model = read_text(box_json(R"(, "circles": [{"center": [0.03,0.03,0.06],
      "normal": [0,0,3], "radius": 0.015}])"),
                                    "box.json")
                              .model;
  ASSERT_THAT(model.points, SizeIs(8 + 1 + 6));
  EXPECT_EQ(model.points[8].type, FeatureType::kConicCentre);
  EXPECT_EQ(model.points[8].part, 0);
  EXPECT_EQ(model.points[8].normal, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(model.points[9].type, FeatureType::kCentroid);
  EXPECT_TRUE(model.points[9].xyz.isApprox(Eigen::Vector3d(0.06, 0.04, 0.0), 1e-12));
  EXPECT_TRUE(model.points[9].normal->isApprox(-Eigen::Vector3d::UnitZ(), 1e-12));
}

TEST(DeriveModel, AddsNoCentroidsWhereSomeAreListed) {
  const MonoModel model =
      read_text(
          "{" + std::string(kBoxPoints) +
              R"(, "circles": [{"center": [0.03,0.03,0.06], "normal": [0,0,1], "radius": 0.01}],
                    "faces": [[4,5,6,7]]})",
          "box.json")
          .model;
  EXPECT_THAT(model.points, SizeIs(10));
  const MonoModel listed =
      read_text(
          R"({"points": [[0,0,0],[0.1,0,0],[0.1,0.1,0],[0,0.1,0],{"xyz":[0.05,0.05,0],"type":"centroid"}],
          "faces": [[0,1,2,3],[0,1,2]]})",
          "tile.json")
          .model;
  EXPECT_THAT(listed.points, SizeIs(5));
  EXPECT_EQ(listed.points[4].part, 0);
}

TEST(DeriveModel, TurnsTheFacesOfSolidsOutward) {
  const std::string inward =
      "{" + std::string(kBoxPoints) +
      R"(, "faces": [[1,2,3,0],[7,6,5,4],[4,5,1,0],[5,6,2,1],[6,7,3,2],[7,4,0,3]]})";
  const auto read = read_text(inward, "box.json");
  expect_outward(read.model);
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("6 of 6 faces were wound inward")));
  const std::string one =
      "{" + std::string(kBoxPoints) +
      R"(, "faces": [[1,2,3,0],[4,5,6,7],[0,1,5,4],[1,2,6,5],[2,3,7,6],[3,0,4,7]]})";
  const auto mixed = read_text(one, "box.json");
  expect_outward(mixed.model);
  EXPECT_THAT(mixed.warnings, ElementsAre(HasSubstr("1 of 6 faces")));
}

TEST(DeriveModel, LeavesOpenAndNonManifoldFacesAsTheyAreAndSaysSo) {
  const auto open = read_text(
      "{" + std::string(kBoxPoints) + R"(, "faces": [[1,2,3,0],[4,5,6,7],[0,1,5,4]]})", "box.json");
  EXPECT_THAT(open.warnings, ElementsAre(HasSubstr("not closed")));
  EXPECT_THAT(open.model.faces[0], ElementsAre(1, 2, 3, 0));
  const auto crowded = read_text(box_json(), "box.json");
  const auto fin = read_text(
      "{" + std::string(kBoxPoints) + R"(, "faces": [[0,3,2,1],[0,1,5,4],[0,1,6,7]]})", "box.json");
  EXPECT_THAT(fin.warnings, ElementsAre(HasSubstr("side 0-1 (3 faces) belongs to more than two")));
}

TEST(DeriveModel, MergesPointsAtOnePlaceAndSaysSo) {
  const auto read = read_text(
      R"({"points": [[0,0,0],[0.1,0,0],[0.1,0,0],[0,0.1,0],[0,0,0.1]], "edges": [[0,2],[1,2],[2,4]]})",
      "a.json");
  EXPECT_THAT(read.model.points, SizeIs(4));
  EXPECT_THAT(read.model.edges, ElementsAre(ElementsAre(0, 1), ElementsAre(1, 3)));
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("point 2 lies where an earlier one does")));
}

TEST(DeriveModel, RefusesFacesThatAreNoPlane) {
  EXPECT_THAT(refusal_of(R"({"points": [[0,0,0],[0.1,0,0],[0.1,0.1,0.05],[0,0.1,0],[0,0,-0.1]],
                             "faces": [[0,1,2,3]]})",
                         "a.json"),
              HasSubstr("face 0 is no plane"));
  EXPECT_THAT(refusal_of(R"({"points": [[0,0,0],[0.1,0,0],[0.2,0,0],[0,0.1,0]],
                             "faces": [[0,1,2]]})",
                         "a.json"),
              HasSubstr("face 0 has no area"));
}

TEST(DeriveModel, KeepsListedSymmetriesEvenThoseOfThePatternOnly) {
  const std::string half_turn =
      R"(, "symmetries": [[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],
                          [-1,0,0,0.2,0,-1,0,0.1,0,0,1,0,0,0,0,1]]})";
  const std::string points = R"({"points": [[0,0,0],[0.15,0,0],[0.15,0.1,0],[0,0.1,0]])";
  const auto read = read_text(points + half_turn, "board.json");
  EXPECT_THAT(read.model.symmetries, SizeIs(2));
  EXPECT_EQ(read.model.symmetry_class, "c2");
  EXPECT_THAT(read.warnings, Contains(HasSubstr("symmetry 1 does not map the points")));
}

TEST(DeriveModel, GivesAFlatModelNoNormalsSoThatBothSidesAreSeen) {
  const MonoModel model = read_text(
                              R"({"circles": [{"center":[0,0,0],"normal":[0,0,1],"radius":0.01},
                      {"center":[0.1,0,0],"normal":[0,0,1],"radius":0.01},
                      {"center":[0,0.1,0],"normal":[0,0,1],"radius":0.01}]})",
                              "dots.json")
                              .model;
  for (const auto& p : model.points) EXPECT_FALSE(p.normal);
}

TEST(DeriveModel, WarnsOfUnlikelyUnits) {
  const auto read = read_text(R"({"points": [[0,0,0],[120,0,0],[0,80,0],[0,0,60]]})", "a.json");
  EXPECT_THAT(read.warnings, ElementsAre(HasSubstr("check its units")));
}

}  // namespace
}  // namespace landmarkdb
