#include "engine/cloud/read_text.hpp"

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::parse;
using ::testing::ThrowsMessage;

void expect_the_two_points(const char* file, const std::string& name) {
  const PointCloud cloud = parse(file, name);
  ASSERT_EQ(cloud.size(), 2U) << file;
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(4, 5, 6)) << file;
}

TEST(ReadText, ReadsPlainCoordinatesAndSkipsComments) {
  const PointCloud cloud = parse(testing::xyz_text(6), "a.xyz");
  ASSERT_EQ(cloud.size(), 6U);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(cloud.points[static_cast<std::size_t>(i)], testing::point(i));
  }
  EXPECT_TRUE(cloud.colours.empty());
}

TEST(ReadText, ReadsPtsWithIntensityAndColour) {
  const PointCloud cloud = parse(testing::pts_text(6), "a.pts");
  ASSERT_EQ(cloud.size(), 6U);
  ASSERT_EQ(cloud.colours.size(), 6U);
  EXPECT_EQ(cloud.colours[2], (std::array<std::uint8_t, 3>{10, 20, 30}));
}

TEST(ReadText, AcceptsCommasTabsSemicolonsAndColumnNames) {
  for (const char* file : {"x,y,z\n1,2,3\n4, 5, 6\n",
                           "1\t2\t3\r\n4\t5\t6\r\n",
                           "//X Y Z\n1;2;3\n4;5;6",
                           "1 2 3 0.25\n4 5 6 0.5\n"}) {
    expect_the_two_points(file, "a.txt");
  }
}

TEST(ReadText, GoesByTheNamesOfColumns) {
  for (const char* file : {"id,x,y,z\n900001,1,2,3\n900002,4,5,6\n",
                           "y x z\n2 1 3\n5 4 6\n",
                           "y x z\n2 1 3 0.5\n5 4 6 0.5\n",
                           "id,x [m],y [m],z [m]\n900001,1,2,3\n900002,4,5,6\n",
                           "\xef\xbb\xbf\"Z[m]\";\"Y[m]\";\"X[m]\"\r\n3;2;1\r\n6;5;4\r\n"}) {
    expect_the_two_points(file, "a.csv");
  }
  const PointCloud all =
      parse("R,G,B,normal_x,normal_y,normal_z,X,Y,Z,time\n1,2,3,0,0,1,7,8,9,0.5\n", "a.csv");
  EXPECT_EQ(all.points.at(0), Eigen::Vector3f(7, 8, 9));
  EXPECT_EQ(all.normals.at(0), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(all.colours.at(0), (std::array<std::uint8_t, 3>{1, 2, 3}));
  EXPECT_TRUE(parse("x y z a b c\n1 2 3 255 0 0\n", "a.csv").colours.empty())
      << "what has another name is no colour";
  EXPECT_TRUE(parse("x y z r g b\n1 2 3 0.25 0.5 1\n", "a.csv").colours.empty()) << "shares";
}

TEST(ReadText, RefusesNamesThatDoNotSayWhatIsX) {
  EXPECT_THAT(
      [&] { parse("id,range,angle\n1,2,3\n", "a.csv"); },
      ThrowsMessage<Error>(AllOf(HasSubstr("id, range, angle"), HasSubstr("want x, y and z"))));
  for (const char* title : {"Scan of the lobby, second floor",
                            "Points x y z of the lobby",
                            "X (m) Y (m) Z (m)",
                            "X Y Z Intensity"}) {
    EXPECT_EQ(parse(std::string(title) + "\n1 2 3\n", "a.xyz").size(), 1U) << title;
  }
}

TEST(ReadText, SkipsAByteOrderMark) {
  EXPECT_EQ(parse("\xef\xbb\xbf"
                  "1 2 3\n4 5 6\n",
                  "a.xyz")
                .size(),
            2U);
}

TEST(ReadText, TellsColoursFromNormals) {
  const PointCloud coloured = parse("1 2 3 255 0 0\n4 5 6 0 12 1\n", "a.xyz");
  EXPECT_EQ(coloured.colours.size(), 2U);
  EXPECT_TRUE(coloured.normals.empty());
  const PointCloud oriented = parse("1 2 3 0.6 0 0.8\n4 5 6 0 0 -1\n", "a.xyz");
  EXPECT_TRUE(oriented.colours.empty());
  ASSERT_EQ(oriented.normals.size(), 2U);
  EXPECT_EQ(oriented.normals[1], Eigen::Vector3f(0, 0, -1));
  const PointCloud neither = parse("1 2 3 0.5 9 7.5\n4 5 6 1 2 3\n", "a.xyz");
  EXPECT_TRUE(neither.colours.empty());
  EXPECT_TRUE(neither.normals.empty());
}

TEST(ReadText, RefusesDecimalCommas) {
  EXPECT_THAT([&] { parse("1,5 2,5 3,5\n", "a.xyz"); },
              ThrowsMessage<Error>(HasSubstr("decimal commas")));
}

TEST(ReadText, RefusesAWrongCount) {
  EXPECT_THAT([&] { parse("1000000000000\n1 2 3\n", "a.pts"); },
              ThrowsMessage<Error>(HasSubstr("promises 1000000000000")));
  EXPECT_THAT([&] { parse("3\n1 2 3\n4 5 6\n#padding\n", "a.pts"); },
              ThrowsMessage<Error>(HasSubstr("promises 3 points, but has 2")));
  EXPECT_THAT([&] { parse("1\n1 2 3\n4 5 6\n", "a.pts"); },
              ThrowsMessage<Error>(HasSubstr("line 3")));
  EXPECT_EQ(parse("1\n1 2 3\n2\n4 5 6\n7 8 9\n", "a.pts").size(), 3U);
}

TEST(ReadText, NamesTheLineAtFault) {
  EXPECT_THAT([&] { parse("1 2 3\n4 5\n", "a.xyz"); },
              ThrowsMessage<Error>(HasSubstr("line 2 has 2 columns, want 3")));
  EXPECT_THAT([&] { parse("1 2 3\n4 five 6\n", "a.xyz"); },
              ThrowsMessage<Error>(HasSubstr("line 2: \"five\"")));
  EXPECT_THAT([&] { parse("hello\n", "a.xyz"); }, ThrowsMessage<Error>(HasSubstr("without any")));
  EXPECT_THAT([&] { parse("1,,3\n", "a.csv"); }, ThrowsMessage<Error>(HasSubstr("empty column")));
}

}  // namespace
}  // namespace landmarkdb
