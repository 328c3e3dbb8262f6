#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using testing::parse;
using testing::point;
using testing::put;
using ::testing::ThrowsMessage;

void expect_points(const PointCloud& cloud, int points) {
  ASSERT_EQ(cloud.size(), static_cast<std::size_t>(points));
  for (int i = 0; i < points; ++i) {
    EXPECT_EQ(cloud.points[static_cast<std::size_t>(i)], point(i)) << i;
  }
}

TEST(ReadPly, ReadsAsciiWithAnyPropertyOrderAndLists) {
  const PointCloud cloud = parse(testing::ply_ascii(9), "a.ply");
  expect_points(cloud, 9);
  ASSERT_EQ(cloud.normals.size(), 9U);
  EXPECT_EQ(cloud.normals[3], Eigen::Vector3f(0, 0, 1));
  ASSERT_EQ(cloud.colours.size(), 9U);
  EXPECT_EQ(cloud.colours[3], (std::array<std::uint8_t, 3>{3, 20, 30}));
}

TEST(ReadPly, ReadsBothByteOrdersAndSkipsOtherElements) {
  for (const bool big_endian : {false, true}) {
    const PointCloud cloud = parse(testing::ply_binary(9, big_endian), "a.ply");
    expect_points(cloud, 9);
    ASSERT_EQ(cloud.colours.size(), 9U);
    EXPECT_EQ(cloud.colours[5], (std::array<std::uint8_t, 3>{5, 20, 30}));
  }
}

TEST(ReadPly, AcceptsWindowsLineEnds) {
  std::string file = testing::ply_ascii(3);
  for (std::size_t at = 0; (at = file.find('\n', at)) != std::string::npos; at += 2) {
    file.insert(at, "\r");
  }
  expect_points(parse(file, "a.ply"), 3);
}

TEST(ReadPly, KeepsNanPointsForTheSanitiser) {
  const std::string file =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nend_header\nnan -nan inf\n1 2 +3.5e0";
  const PointCloud cloud = parse(file, "a.ply");
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_FALSE(cloud.points[0].allFinite());
  EXPECT_EQ(cloud.points[1], Eigen::Vector3f(1, 2, 3.5F));
}

TEST(ReadPly, ReadsBackTheViewpointsOfItsComments) {
  const std::string file =
      "ply\nformat ascii 1.0\ncomment viewpoint 1 2 3\ncomment viewpoint 4 5 6\n"
      "element vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property ushort viewpoint\nend_header\n0 0 0 1\n1 1 1 0\n";
  const PointCloud cloud = parse(file, "a.ply");
  ASSERT_EQ(cloud.viewpoints.size(), 2U);
  EXPECT_EQ(cloud.viewpoints[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_THAT(cloud.viewpoint_index, ::testing::ElementsAre(1, 0));
  std::string wrong = file;
  wrong.replace(wrong.find("0 0 0 1"), 7, "0 0 0 2");
  EXPECT_THAT([&] { parse(wrong, "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("viewpoint number 2")));
}

TEST(ReadPly, RefusesCountsTheFileCannotHold) {
  for (const char* count : {"1000000000000", "21", "18446744073709551615"}) {
    for (std::string file : {testing::ply_ascii(20), testing::ply_binary(20, false)}) {
      const std::string wanted = "element vertex 20";
      file.replace(file.find(wanted), wanted.size(), std::string("element vertex ") + count);
      EXPECT_THROW(parse(file, "a.ply"), Error) << count;
    }
  }
  for (const char* count : {"-1", "1e3", "99999999999999999999", ""}) {
    std::string file = testing::ply_ascii(20);
    file.replace(file.find("vertex 20"), 9, std::string("vertex ") + count);
    EXPECT_THAT([&] { parse(file, "a.ply"); }, ThrowsMessage<Error>(HasSubstr("no count")));
  }
}

TEST(ReadPly, RefusesAListLongerThanTheFile) {
  std::string file =
      "ply\nformat binary_little_endian 1.0\nelement blob 1\nproperty list uint double data\n"
      "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  put<std::uint32_t>(file, std::numeric_limits<std::uint32_t>::max());
  for (int i = 0; i < 3; ++i) put(file, 1.0F);
  EXPECT_THROW(parse(file, "a.ply"), Error);
}

TEST(ReadPly, RefusesTruncatedData) {
  for (const std::string& whole :
       {testing::ply_ascii(5), testing::ply_binary(5, false), testing::ply_mesh_ascii()}) {
    for (std::size_t size = 4; size + 2 < whole.size(); ++size) {
      EXPECT_THROW(parse(whole.substr(0, size), "a.ply"), Error) << size;
    }
  }
}

TEST(ReadPly, NamesWhatIsWrongInTheHeader) {
  const auto with = [](const std::string& line) {
    return "ply\nformat ascii 1.0\n" + line + "\nend_header\n";
  };
  EXPECT_THAT([&] { parse(with("element vertex 0"), "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("no vertices")));
  EXPECT_THAT([&] { parse(with("property float x"), "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("before any element")));
  EXPECT_THAT([&] { parse(with("element vertex 0\nproperty half x"), "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("\"half\"")));
  EXPECT_THAT([&] { parse("ply\nformat ascii 2.0\nend_header\n", "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("\"2.0\"")));
  EXPECT_THAT([&] { parse("ply\n" + std::string(100'000, 'x') + "\n", "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("characters")));
  std::string many = "element vertex 0\n";
  for (int i = 0; i < 600; ++i) many += "property float p\n";
  EXPECT_THAT([&] { parse(with(many), "a.ply"); },
              ThrowsMessage<Error>(HasSubstr("more than 512")));
}

TEST(ReadPly, SamplesFacesInsteadOfReturningCorners) {
  const PointCloud cloud = parse(testing::ply_mesh_ascii(), "a.ply", {.mesh_spacing_m = 0.05});
  // 2 square metres, one point a 0.05 m x 0.05 m.
  EXPECT_NEAR(static_cast<double>(cloud.size()), 800.0, 2.0);
  for (const Eigen::Vector3f& p : cloud.points) {
    EXPECT_EQ(p.z(), 0.0F);
    EXPECT_TRUE(p.x() >= 0.0F && p.x() <= 2.0F && p.y() >= 0.0F && p.y() <= 1.0F);
  }
  std::string wrong = testing::ply_mesh_ascii();
  wrong.replace(wrong.find("4 0 1 2 3"), 9, "4 0 1 2 4");
  EXPECT_THAT([&] { parse(wrong, "a.ply"); }, ThrowsMessage<Error>(HasSubstr("there are 4")));
}

}  // namespace
}  // namespace landmarkdb
