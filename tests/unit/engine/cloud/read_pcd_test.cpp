#include <bit>
#include <cmath>

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

std::string with_replaced(std::string file, const std::string& what, const std::string& by) {
  const std::size_t at = file.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return file.replace(at, what.size(), by);
}

TEST(ReadPcd, ReadsAsciiWithAnyFieldOrderSizeAndCount) {
  const PointCloud cloud = parse(testing::pcd_ascii(9), "a.pcd");
  ASSERT_EQ(cloud.size(), 9U);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(cloud.points[static_cast<std::size_t>(i)], point(i));
  ASSERT_EQ(cloud.colours.size(), 9U);
  EXPECT_EQ(cloud.colours[0], (std::array<std::uint8_t, 3>{10, 20, 30}));
  EXPECT_TRUE(cloud.viewpoints.empty()) << "an identity viewpoint of a list of points says nothing";
}

TEST(ReadPcd, AViewpointIsWherePointsWereTakenFromAndMovesNone) {
  const PointCloud cloud = parse(testing::pcd_binary(9), "a.pcd");
  ASSERT_EQ(cloud.size(), 9U);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(cloud.points[static_cast<std::size_t>(i)], point(i));
  ASSERT_EQ(cloud.normals.size(), 9U);
  EXPECT_EQ(cloud.normals[4], Eigen::Vector3f(1, 0, 0));
  ASSERT_EQ(cloud.viewpoints.size(), 1U);
  EXPECT_EQ(cloud.viewpoints[0], Eigen::Vector3f(1, 2, 3));
}

TEST(ReadPcd, ReadsCompressedOrganisedClouds) {
  const PointCloud cloud = parse(testing::pcd_compressed(20), "a.pcd");
  ASSERT_EQ(cloud.size(), 20U);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(cloud.points[static_cast<std::size_t>(i)], point(i));
  EXPECT_EQ(cloud.width, 10U);
  EXPECT_EQ(cloud.height, 2U);
  ASSERT_EQ(cloud.viewpoints.size(), 1U) << "an organised cloud was seen from its zero";
}

TEST(ReadPcd, TakesColourFromTheBitsOfAFloat) {
  std::string file =
      "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
  for (int i = 0; i < 3; ++i) put(file, 1.0F);
  put(file, std::uint32_t{0x00C86432});
  const PointCloud cloud = parse(file, "a.pcd");
  ASSERT_EQ(cloud.colours.size(), 1U);
  EXPECT_EQ(cloud.colours[0], (std::array<std::uint8_t, 3>{200, 100, 50}));
}

TEST(ReadPcd, ReadsNanAndOldHeaders) {
  const std::string file =
      "# .PCD v.5\nVERSION .5\nCOLUMNS x y z\nPOINTS 2\nDATA ascii\nnan nan nan\n1 2 3\n";
  const PointCloud cloud = parse(file, "a.pcd");
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_TRUE(std::isnan(cloud.points[0].x()));
}

TEST(ReadPcd, RefusesCountsTheFileCannotHold) {
  const std::string huge = "1000000000000";
  for (const std::string& file :
       {testing::pcd_ascii(20), testing::pcd_binary(20), testing::pcd_compressed(20)}) {
    const bool organised = file.find("HEIGHT 2") != std::string::npos;
    std::string lying = with_replaced(file, "POINTS 20", "POINTS " + huge);
    EXPECT_THAT([&] { parse(lying, "a.pcd"); }, ThrowsMessage<Error>(HasSubstr("is not POINTS")));
    lying = organised ? with_replaced(lying, "WIDTH 10", "WIDTH 500000000000")
                      : with_replaced(lying, "WIDTH 20", "WIDTH " + huge);
    EXPECT_THAT([&] { parse(lying, "a.pcd"); }, ThrowsMessage<Error>(HasSubstr("promises")));
  }
}

TEST(ReadPcd, RefusesProductsBeyond64Bits) {
  std::string file =
      with_replaced(testing::pcd_binary(20), "WIDTH 20", "WIDTH 9223372036854775808");
  EXPECT_THROW(parse(with_replaced(file, "HEIGHT 1", "HEIGHT 2"), "a.pcd"), Error);
  EXPECT_THROW(
      parse(with_replaced(testing::pcd_binary(20), "COUNT 1 3", "COUNT 1 4294967296"), "a"), Error);
  EXPECT_THROW(parse(with_replaced(testing::pcd_binary(20), "COUNT 1 3", "COUNT 1 -3"), "a"),
               Error);
}

TEST(ReadPcd, RefusesDamagedCompression) {
  const std::string whole = testing::pcd_compressed(20);
  const std::size_t body = whole.find("compressed\n") + 11;
  std::string wrong = whole;
  wrong[body + 8] = '\xff';  // a back reference before any byte was written
  EXPECT_THAT([&] { parse(wrong, "a.pcd"); }, ThrowsMessage<Error>(HasSubstr("damaged")));
  wrong = whole;
  wrong[body + 4] = '\x01';  // another unpacked size
  EXPECT_THAT([&] { parse(wrong, "a.pcd"); }, ThrowsMessage<Error>(HasSubstr("unfolds")));
  EXPECT_THROW(parse(whole.substr(0, whole.size() - 1), "a.pcd"), Error);
}

TEST(ReadPcd, RefusesTruncatedData) {
  for (const std::string& whole :
       {testing::pcd_ascii(5), testing::pcd_binary(5), testing::pcd_compressed(4)}) {
    for (std::size_t size = 12; size + 2 < whole.size(); ++size) {
      EXPECT_THROW(parse(whole.substr(0, size), "a.pcd"), Error) << size;
    }
  }
}

TEST(ReadPcd, NamesWhatIsWrongInTheHeader) {
  const std::string file = testing::pcd_ascii(2);
  EXPECT_THAT([&] { parse(with_replaced(file, "rgb x", "rgb q"), "a.pcd"); },
              ThrowsMessage<Error>(HasSubstr("no x, y, z")));
  EXPECT_THAT([&] { parse(with_replaced(file, "TYPE U F", "TYPE U Q"), "a.pcd"); },
              ThrowsMessage<Error>(HasSubstr("\"Q\"")));
  EXPECT_THAT([&] { parse(with_replaced(file, "SIZE 4 4 4 8 2", "SIZE 4 4 4 8"), "a.pcd"); },
              ThrowsMessage<Error>(HasSubstr("SIZE")));
  EXPECT_THAT([&] { parse(with_replaced(file, "0 0 0 1 0 0 0", "0 0 0 1 0 0 x"), "a.pcd"); },
              ThrowsMessage<Error>(HasSubstr("VIEWPOINT")));
  EXPECT_THAT([&] { parse(with_replaced(file, "DATA ascii", "DATA magic"), "a.pcd"); },
              ThrowsMessage<Error>(HasSubstr("\"magic\"")));
}

}  // namespace
}  // namespace landmarkdb
