// The indexer's model commands, run through its binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "store/sqlite.hpp"
#include "tests/unit/indexer/indexer_fixture.hpp"

namespace landmarkdb::indexer::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ModelPrograms : public IndexerProgram {
 protected:
  static std::string box() { return std::string(LANDMARKDB_SOURCE) + "/datasets/models/box.json"; }
};

TEST_F(ModelPrograms, AddListShowAndRemoveABox) {
  const auto added = run_json({"model", "add", "box", box()});
  EXPECT_EQ(added.at("name"), "box");
  EXPECT_EQ(added.at("replaced"), false);
  EXPECT_EQ(added.at("points"), 8 + 2 + 6);
  EXPECT_EQ(added.at("points_of_type").at("conic_centre"), 2);
  EXPECT_EQ(added.at("edges"), 12);
  EXPECT_EQ(added.at("triples"), 24);
  EXPECT_EQ(added.at("symmetry"), "none");
  EXPECT_NEAR(added.at("diameter_m").get<double>(), 0.1562, 1e-4);
  EXPECT_THAT(added.at("warnings"), ElementsAre());

  EXPECT_EQ(run_json({"model", "list"}).at("models").size(), 1U);
  const auto shown = run_json({"model", "show", "box"}).at("model");
  EXPECT_EQ(shown.at("units"), "m");
  EXPECT_DOUBLE_EQ(shown.at("points")[1].at("xyz")[0].get<double>(), 0.12);
  EXPECT_EQ(shown.at("symmetries").size(), 1U);
  EXPECT_THAT(run({"model", "show", "box"}).out, HasSubstr("conic_centre"));

  EXPECT_EQ(run_json({"model", "rename", "box", "parcel"}).at("model"), "parcel");
  EXPECT_EQ(run_json({"model", "remove", "parcel"}).at("removed"), "parcel");
  EXPECT_EQ(run({"model", "list"}).out, "no models\n");
  EXPECT_EQ(run({"model", "show", "parcel"}).status, 3);
}

TEST_F(ModelPrograms, KeepScenesApart) {
  add("box");
  EXPECT_EQ(run_json({"model", "add", "box", box()}).at("replaced"), false);
  EXPECT_EQ(run_json({"model", "add", "box", box()}).at("replaced"), true);
  EXPECT_EQ(run_json({"list"}).at("scenes").size(), 1U);
  const auto checked = run_json({"check"});
  EXPECT_EQ(checked.at("models"), 1);
  EXPECT_EQ(checked.at("ok"), true);
}

TEST_F(ModelPrograms, ExportAndImportGiveTheSameModel) {
  run_json({"model", "add", "box", box()});
  EXPECT_EQ(run_json({"export", "box", path("box.model")}).at("model"), "box");
  const auto before = run_json({"model", "show", "box"}).at("model");
  run_json({"model", "remove", "box"});
  EXPECT_EQ(run_json({"import", path("box.model")}).at("model"), "box");
  EXPECT_EQ(run_json({"model", "show", "box"}).at("model"), before);
  EXPECT_EQ(run_json({"import", path("box.model"), "--as", "twin"}).at("model"), "twin");
  // An export never writes over a file.
  EXPECT_NE(run({"export", "twin", path("box.model")}).status, 0);
}

TEST_F(ModelPrograms, AnExportOfANameThatBothHaveIsTheScene) {
  add("box");
  run_json({"model", "add", "box", box()});
  EXPECT_EQ(run_json({"export", "box", path("a")}).at("scene"), "box");
  EXPECT_EQ(run_json({"export", "box", path("b"), "--model"}).at("model"), "box");
}

TEST_F(ModelPrograms, TellWhatTheyChangedOnStandardError) {
  write("open.json",
        R"({"points": [[0,0,0],[100,0,0],[100,100,0],[0,100,0],[0,0,80]], "units": "mm",
            "faces": [[0,1,2,3],[0,1,4]]})");
  const RunResult result = run({"model", "add", "open", path("open.json")});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.err, HasSubstr("not closed"));
  EXPECT_THAT(result.out, HasSubstr("added model open: 7 points"));
}

TEST_F(ModelPrograms, BadFilesLeaveNoDatabaseBehind) {
  write("line.json", R"({"points": [[0,0,0],[1,0,0],[2,0,0]]})");
  write("cut.obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n");
  for (const char* file : {"line.json", "cut.obj", "none.json"}) {
    const RunResult result = run({"model", "add", "x", path(file)});
    EXPECT_EQ(result.status, 7) << file;
    EXPECT_THAT(result.err, HasSubstr(file));
    EXPECT_FALSE(std::filesystem::exists(db_)) << file;
  }
  EXPECT_EQ(run({"model", "add", "a/b", box()}).status, 2);
  EXPECT_EQ(run({"model", "add", "x", box(), "--units", "feet"}).status, 2);
  EXPECT_EQ(run({"model"}).status, 2);
}

TEST_F(ModelPrograms, RepairMakesTriplesAnew) {
  run_json({"model", "add", "box", box()});
  sqlite::Database(db_, sqlite::OpenMode::kReadWrite, std::chrono::milliseconds(0))
      .execute("DELETE FROM mono_triple WHERE i0 = 1");
  EXPECT_EQ(run({"check"}).status, 5);
  EXPECT_EQ(run({"repair"}).status, 0);
  EXPECT_EQ(run({"check"}).status, 0);
  EXPECT_EQ(run_json({"model", "show", "box"}).at("triples"), 24);
}

}  // namespace
}  // namespace landmarkdb::indexer::testing
