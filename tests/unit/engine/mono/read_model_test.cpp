#include "engine/mono/read_model.hpp"

#include <filesystem>
#include <fstream>

#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using testing::box_json;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::read_text;
using testing::refusal_of;
using ::testing::SizeIs;

TEST(ReadModel, TakesNameSourceAndUnitsFromTheFile) {
  const auto read = read_text(
      R"({"name": "tile", "units": "mm", "points": [[0,0,0],[50,0,0],[0,20,0]], "note": 1})",
      "/some/where/tile-v2.json");
  EXPECT_EQ(read.model.name, "tile");
  EXPECT_EQ(read.model.source, "tile-v2.json");
  EXPECT_DOUBLE_EQ(read.model.unit_scale, 0.001);
  EXPECT_NEAR(read.model.diameter_m, std::hypot(0.05, 0.02), 1e-15);
  EXPECT_EQ(read_text(R"({"points": [[0,0,0],[1,0,0],[0,1,0]]})", "a/b.json").model.name, "b");
}

TEST(ReadModel, UnitsGivenOutsideCountWhereTheFileSaysNone) {
  const std::string bare = R"({"points": [[0,0,0],[5,0,0],[0,2,0]]})";
  EXPECT_NEAR(
      read_text(bare, "a.json", {.units = Units::kInches}).model.points[1].xyz.x(), 0.127, 1e-15);
  EXPECT_THROW(read_text(R"({"units": "cm", "points": [[0,0,0],[5,0,0],[0,2,0]]})",
                         "a.json",
                         {.units = Units::kMillimetres}),
               Error);
}

TEST(ReadModel, ReadsEveryFormOfAPoint) {
  const auto read = read_text(
      R"({"points": [[0,0,0], {"xyz": [0.1,0,0]}, {"xyz": [0,0.1,0], "type": "inflexion"},
          {"xyz": [0,0,0.1], "type": "vertex", "normal": [0,0,2]}]})",
      "a.json");
  ASSERT_THAT(read.model.points, SizeIs(4));
  EXPECT_EQ(read.model.points[1].type, FeatureType::kVertex);
  EXPECT_EQ(read.model.points[2].type, FeatureType::kInflexion);
  EXPECT_FALSE(read.model.points[0].normal);
  EXPECT_EQ(read.model.points[3].normal, Eigen::Vector3d::UnitZ());
}

TEST(ReadModel, AcceptsThreePointsAndSaysTheyAreFew) {
  const auto read = read_text(R"({"points": [[0,0,0],[0.1,0,0],[0,0.1,0]]})", "a.json");
  EXPECT_THAT(read.model.points, SizeIs(3));
  EXPECT_THAT(read.warnings, Contains(HasSubstr("has 3 points")));
}

TEST(ReadModel, WritesWhatItReadsBackToTheSameModel) {
  const MonoModel model =
      read_text(box_json(R"(, "circles": [{"center": [0.03,0.03,0.06], "normal": [0,0,1],
                         "radius": 0.015}])"),
                "box.json")
          .model;
  const auto again = read_text(model_to_json(model), "box.json");
  EXPECT_EQ(model_to_json(again.model), model_to_json(model));
  EXPECT_EQ(again.model.symmetry_class, model.symmetry_class);
  ASSERT_EQ(again.model.points.size(), model.points.size());
  for (std::size_t i = 0; i < model.points.size(); ++i) {
    EXPECT_EQ(again.model.points[i].xyz, model.points[i].xyz);
    EXPECT_EQ(again.model.points[i].part, model.points[i].part);
    EXPECT_EQ(again.model.points[i].normal.has_value(), model.points[i].normal.has_value());
  }
}

TEST(ReadModel, NamesWhatIsWrong) {
  const std::string three = R"("points": [[0,0,0],[0.1,0,0],[0,0.1,0]])";
  for (const auto& [text, want] : {
           std::pair<std::string, std::string>{"{", "not valid JSON"},
           {"{\"points\": 3}", "\"points\" is a number"},
           {R"({"points": [[0,0],[1,0,0],[0,1,0]]})", "point 0 is 2 numbers"},
           {R"({"points": [[0,0,"x"],[1,0,0],[0,1,0]]})", "point 0 has a string"},
           {R"({"points": [[0,0,1e300],[1,0,0],[0,1,0]]})", "point 0 has the coordinate 1e+300 m"},
           {R"({"points": [{"xyz": [0,0,0], "type": "corner"}]})", "type \"corner\""},
           {R"({"points": [{"type": "vertex"}]})", "point 0 has no \"xyz\""},
           {R"({"points": [{"xyz": [0,0,0], "normal": [0,0,0]}]})", "point 0's normal"},
           {"{" + three + R"(, "units": "feet"})", "\"feet\""},
           {"{" + three + R"(, "edges": [[0,3]]})", "edge 0 names point \"3\""},
           {"{" + three + R"(, "edges": [[0,-1]]})", "edge 0 names point \"-1\""},
           {"{" + three + R"(, "edges": [[1,1]]})", "joins point 1 with itself"},
           {"{" + three + R"(, "faces": [[0,1]]})", "face 0 has fewer than 3"},
           {"{" + three + R"(, "faces": [[0,1,1]]})", "face 0 has fewer than 3 different"},
           {"{" + three + R"(, "circles": [{"center": [0,0,0], "radius": 1}]})", "no \"normal\""},
           {"{" + three + R"(, "circles": [{"center": [0,0,0], "normal": [0,0,1], "radius": 0}]})",
            "radius 0"},
           {"{" + three + R"(, "symmetries": [[1,2,3]]})", "symmetry 0 is no list of 16"},
           {"{" + three + R"(, "symmetries": [[2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1]]})",
            "symmetry 0 is no rigid motion"},
           {R"({"points": [[0,0,0],[0.1,0,0]]})", "has 2 points, want at least 3"},
           {R"({"points": [[0,0,0],[0.1,0,0],[0.3,0,0]]})", "all its points on one line"},
           {R"({"points": [[1,1,1],[1,1,1],[1,1,1]]})", "has no extent"},
           {"{}", "has no extent"},
           {"[[0,0,0]]", "no JSON object"},
       }) {
    const std::string said = refusal_of(text, "tile.json");
    EXPECT_THAT(said, HasSubstr(want)) << text;
    EXPECT_THAT(said, HasSubstr("tile.json")) << text;
  }
}

TEST(ReadModel, RefusesOverItsLimitsBeforeBuilding) {
  std::string points = "{\"points\": [[0,0,0]";
  for (std::size_t i = 0; i < kMaxModelPoints; ++i) points += ",[1,2," + std::to_string(i) + "]";
  EXPECT_THAT(refusal_of(points + "]}", "a.json"), HasSubstr("257 points, want at most 256"));
  EXPECT_THAT(refusal_of("{\"points\":" + std::string(100, '[') + std::string(100, ']') + "}", "a"),
              HasSubstr("nested too deeply"));
}

TEST(ReadModel, SaysWhatItWantsOfOtherFiles) {
  EXPECT_THAT(refusal_of("", "a.json"), HasSubstr("is empty"));
  EXPECT_THAT(refusal_of("\x89PNG\r\n", "a.png"), HasSubstr("want JSON"));
  EXPECT_THROW(read_model("/no/such/model.json", {}), Error);
}

TEST(ReadModel, TellsTheFormatByTheContent) {
  const std::string box =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
  EXPECT_THAT(read_text(box, "no-extension").model.faces, SizeIs(4));
  EXPECT_THAT(read_text("# c\nV1\n3\n0 0 0\n1 0 0\n0 1 0\n0\n0\n0\n0\n0\n", "x").model.points,
              SizeIs(3));
}

TEST(ReadModel, ReadsTheRealModels) {
  const char* data = std::getenv("LANDMARKDB_REAL_DATA");
  if (data == nullptr || !std::filesystem::exists(std::string(data) + "/mono")) {
    GTEST_SKIP() << "LANDMARKDB_REAL_DATA is not set";
  }
  const std::string folder = std::string(data) + "/mono/";
  const auto read = [&](const std::string& name) {
    return read_model(folder + name + ".model.json", {}).model;
  };
  EXPECT_EQ(read("cube84").symmetry_class, "cube");
  EXPECT_THAT(read("cube84").symmetries, SizeIs(24));
  EXPECT_EQ(read("grid36").symmetry_class, "c4");
  EXPECT_THAT(read("grid36").points, SizeIs(36));
  EXPECT_EQ(read("chessboard25").symmetry_class, "c2");  // of the lines, as listed
  EXPECT_EQ(read("castle_simu").symmetry_class, "none");
  EXPECT_THAT(read("castle_simu").points, SizeIs(14 + 5));
}

}  // namespace
}  // namespace landmarkdb
