#include <filesystem>
#include <fstream>

#include "engine/mono/model_draft.hpp"
#include "tests/unit/engine/mono/model_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::read_text;
using testing::refusal_of;
using ::testing::SizeIs;

const std::string kPyramid =
    "# a pyramid and a can\r\nV1\r\n7 # points\n0 0 0\n0.1 0 0 # one\n0.1 0.1 0\n0 0.1 0\n"
    "0.05 0.05 0.1\n0.3 0 0\n0.3 0 0.2\n"
    "4 # lines\n0 1 name=front\n1 2\n2 3\n3 0\n"
    "1 # faces by lines\n4 3 2 1 0\n"
    "4 # faces by points\n3 0 1 4 useLod=true minPolygonAreaThreshold=40\n3 1 2 4\n3 2 3 4\n3 3 0 "
    "4\n"
    "1 # cylinders\n5 6 0.04\n"
    "1 # circles\n0.02 5 0 1\n";

TEST(ParseCao, ReadsPointsLinesFacesCylindersAndCircles) {
  const std::string text = kPyramid.substr(0, kPyramid.rfind("1 # circles"));
  const MonoModel model = read_text(text, "pyramid.cao").model;
  ASSERT_THAT(model.faces, SizeIs(5));
  EXPECT_THAT(model.edges, SizeIs(8));
  ASSERT_THAT(model.circles, SizeIs(2));
  EXPECT_EQ(model.circles[0].normal, -Eigen::Vector3d::UnitZ());
  EXPECT_EQ(model.circles[1].normal, Eigen::Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(model.circles[1].radius_m, 0.04);
  // Five corners; what only places the cylinder is none. Two rims, five faces.
  EXPECT_THAT(model.points, SizeIs(5 + 2 + 5));
}

TEST(ParseCao, TakesACircleByItsCentreAndTwoPointsOfItsPlane) {
  const MonoModel model =
      read_text("V1\n4\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0\n0\n1\n4 0 1 3 2\n0\n1\n0.2 0 1 2\n", "a.cao")
          .model;
  ASSERT_THAT(model.circles, SizeIs(1));
  EXPECT_EQ(model.circles[0].normal, Eigen::Vector3d::UnitZ());
}

TEST(ParseCao, ReadsListsThatAreLeftOutAtTheEnd) {
  EXPECT_THAT(read_text("V1\n3\n0 0 0\n1 0 0\n0 1 0\n", "a.cao").model.points, SizeIs(3));
}

TEST(ParseCao, NamesTheLineAtFault) {
  for (const auto& [text, want] : {
           std::pair<std::string, std::string>{"V0\n1\n", "want the version \"V1\""},
           {"V1\n2\n0 0 0\n", "ends within its points"},
           {"V1\n1\n0 zero 0\n", "line 3: \"zero\" is no number"},
           {"V1\n1\n0 0\n", "line 3: ends early"},
           {"V1\n1\n0 0 0\n1\n0 1\n", "line 5: \"1\", want a point's number below 1"},
           {"V1\n-1\n", "no count of points"},
           {"V1\n99999999999\n", "want at most"},
           {"V1\n3\n0 0 0\n1 0 0\n0 1 0\n2\n0 1\n1 2\n1\n2 0 1\n", "fewer than 3"},
           {"V1\n3\n0 0 0\n1 0 0\n0 1 0\n3\n0 1\n1 2\n0 1\n1\n3 0 1 2\n", "do not follow"},
           {"V1\n3\n0 0 0\n1 0 0\n2 0 0\n0\n0\n0\n0\n1\n0.1 0 1 2\n", "on one line"},
           {"V1\n3\n0 0 0\n1 0 0\n2 0 0\n0\n0\n0\n1\n0 1 -2\n", "radius"},
           {"V1\nload(\"b.cao\")\n0\n", "not followed here"},
       }) {
    EXPECT_THAT(refusal_of(text, "a.cao"), HasSubstr(want)) << text;
  }
}

class CaoParts : public ::testing::Test {
 protected:
  CaoParts() { std::filesystem::create_directories(folder_); }
  ~CaoParts() override { std::filesystem::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  std::filesystem::path folder_ = std::filesystem::path(::testing::TempDir()) /
                                  ("cao-" + std::to_string(::getpid()) +
                                   ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(CaoParts, AreReadFromTheFilesFolder) {
  write("tri.cao", "V1\n3\n0 0 0\n1 0 0\n0 1 0\n0\n0\n1\n3 0 1 2\n");
  const std::string path =
      write("all.cao", "V1\nload(\"tri.cao\")\n3\n0 0 2\n1 0 2\n0 1 2\n0\n0\n1\n3 0 1 2\n0\n0\n");
  const MonoModel model = read_model(path, {}).model;
  EXPECT_THAT(model.faces, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(3, 4, 5)));
  EXPECT_THAT(model.edges, SizeIs(6));
}

TEST_F(CaoParts, OutsideTheFolderOrInACircleAreRefused) {
  EXPECT_THROW(read_model(write("up.cao", "V1\nload(\"../x.cao\")\n0\n"), {}), Error);
  EXPECT_THROW(read_model(write("abs.cao", "V1\nload(\"/etc/passwd\")\n0\n"), {}), Error);
  EXPECT_THROW(read_model(write("me.cao", "V1\nload(\"me.cao\")\n0\n"), {}), Error);
  EXPECT_THROW(read_model(write("moved.cao", "V1\nload(\"me.cao\", t=[1;0;0])\n0\n"), {}), Error);
}

}  // namespace
}  // namespace landmarkdb
