#include "engine/cloud/read_cloud.hpp"

#include <filesystem>
#include <fstream>
#include <stop_token>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/cloud/cloud_files.hpp"

namespace landmarkdb {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::parse;

// The message of the Error that reading throws, or "no error".
std::string message_of(std::string_view file,
                       std::string_view name,
                       const ReadOptions& options = {}) {
  try {
    parse(file, name, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "no error";
}

TEST(ReadCloud, ScalesEveryUnitToMetres) {
  const std::string file = "1000 2000 3000\n";
  const auto first = [&](Units units) {
    return Eigen::Vector3f(parse(file, "a.xyz", {.units = units}).points.at(0));
  };
  EXPECT_TRUE(first(Units::kMillimetres).isApprox(Eigen::Vector3f(1, 2, 3)));
  EXPECT_TRUE(first(Units::kCentimetres).isApprox(Eigen::Vector3f(10, 20, 30)));
  EXPECT_TRUE(first(Units::kInches).isApprox(Eigen::Vector3f(25.4F, 50.8F, 76.2F)));
}

TEST(ReadCloud, KeepsMillimetresOfGeoreferencedCoordinates) {
  std::string file;
  for (int i = 0; i < 100; ++i) {
    file += "432123." + std::to_string(100 + i) + " 5123456.25 312.125\n";
  }
  const PointCloud cloud = parse(file, "utm.xyz");
  ASSERT_EQ(cloud.size(), 100U);
  EXPECT_EQ(cloud.origin, Eigen::Vector3d(432100, 5123500, 300));
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d p =
        cloud.origin + cloud.points[static_cast<std::size_t>(i)].cast<double>();
    EXPECT_NEAR(p.x(), 432123.1 + 0.001 * i, 1e-4);
    EXPECT_NEAR(p.y(), 5123456.25, 1e-4);
  }
}

TEST(ReadCloud, IsNotMovedByOneFarPoint) {
  std::string file = "1e7 1e7 1e7\n";
  for (int i = 0; i < 50; ++i) file += "0.5 1.5 2.5\n";
  EXPECT_TRUE(parse(file, "a.xyz").origin.isZero());
}

TEST(ReadCloud, NamesFormatsItKnowsButDoesNotRead) {
  EXPECT_THAT(message_of("LASF\x01\x02", "scan.las"),
              AllOf(HasSubstr("scan.las"), HasSubstr("LAS"), HasSubstr("convert")));
  EXPECT_THAT(message_of("ASTM-E57 and more", "scan.e57"), HasSubstr("E57"));
  EXPECT_THAT(message_of("\x89PNG\r\n", "depth.png"), HasSubstr("camera file"));
  EXPECT_THAT(message_of("4\n4\n0 0 0\n", "scan.ptx"), HasSubstr("PTX"));
}

TEST(ReadCloud, RefusesWhatIsNoCloud) {
  EXPECT_THAT(message_of("", "empty.ply"), HasSubstr("is empty"));
  EXPECT_THAT(message_of(std::string("\x01\x02\x00\x03", 4), "noise"), HasSubstr("no format"));
  EXPECT_THAT(message_of("hello world\n", "a.ply"), HasSubstr("\"hello world"));
}

TEST(ReadCloud, RecognisesTheFormatFromTheContentNotTheName) {
  EXPECT_EQ(parse(testing::ply_ascii(5), "wrong.pcd").size(), 5U);
  EXPECT_EQ(parse(testing::pcd_binary(5), "wrong.xyz").size(), 5U);
  EXPECT_GT(parse(testing::stl_binary(), "wrong.obj").size(), 100U);
}

TEST(ReadCloud, EnforcesTheLimitOnPoints) {
  const ReadOptions few{.max_points = 10};
  for (const testing::NamedFile& file : testing::one_of_each()) {
    EXPECT_NO_THROW(parse(file.bytes, file.name)) << file.name;
  }
  for (const char* name :
       {"a.ply", "b.ply", "c.ply", "a.pcd", "b.pcd", "c.pcd", "a.xyz", "a.pts"}) {
    for (const testing::NamedFile& file : testing::one_of_each()) {
      if (file.name == name) {
        EXPECT_THAT(message_of(file.bytes, name, few), HasSubstr("10")) << name;
      }
    }
  }
  EXPECT_LE(parse(testing::obj_cube(), "a.obj", few).size(), 10U);
}

TEST(ReadCloud, SaysWhichFileIsMissing) {
  try {
    read_cloud("/nonexistent/cloud.ply", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(error.what(), HasSubstr("/nonexistent/cloud.ply"));
  }
  EXPECT_THROW(read_cloud("/", {}), Error);
  EXPECT_THROW(read_cloud("/dev/zero", {}), Error);
}

TEST(ReadCloud, ReadsAFileFromDisk) {
  const std::filesystem::path path =
      std::filesystem::path(::testing::TempDir()) / "read_cloud_test.xyz";
  std::ofstream(path) << testing::xyz_text(7);
  EXPECT_EQ(read_cloud(path, {}).size(), 7U);
  std::filesystem::remove(path);
}

// Ctrl-C while a large file was read used to wait for its end.
TEST(ReadCloud, StopsInTheMiddleOfAFileOfAnyFormat) {
  constexpr int kPoints = 40'000;
  const std::vector<testing::NamedFile> files = {{"a.ply", testing::ply_ascii(kPoints)},
                                                 {"b.ply", testing::ply_binary(kPoints, false)},
                                                 {"a.pcd", testing::pcd_ascii(kPoints)},
                                                 {"b.pcd", testing::pcd_binary(kPoints)},
                                                 {"a.xyz", testing::xyz_text(kPoints)},
                                                 {"a.pts", testing::pts_text(kPoints)}};
  for (const testing::NamedFile& file : files) {
    std::stop_source stop;
    std::vector<Progress> seen;
    RunContext context;
    context.stop = stop.get_token();
    context.progress = [&](const Progress& progress) {
      seen.push_back(progress);
      if (progress.done > progress.total / 2) stop.request_stop();
    };
    try {
      parse_cloud(testing::as_bytes(file.bytes), file.name, {}, context);
      ADD_FAILURE() << file.name << " was read to its end";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled) << file.name;
    }
    ASSERT_GE(seen.size(), 2U) << file.name;
    EXPECT_EQ(seen.back().stage, "read");
    EXPECT_EQ(seen.back().total, file.bytes.size());
    EXPECT_LT(seen.back().done, file.bytes.size()) << file.name;
  }
}

TEST(ReadCloud, StopsWhileAMeshIsSampled) {
  std::stop_source stop;
  RunContext context;
  context.stop = stop.get_token();
  std::uint64_t reports = 0;
  context.progress = [&](const Progress& progress) {
    if (progress.stage == "sample" && ++reports == 2) stop.request_stop();
  };
  const ReadOptions fine{.mesh_spacing_m = 0.001};
  EXPECT_THROW(parse_cloud(testing::as_bytes(testing::obj_cube()), "a.obj", fine, context), Error);
  EXPECT_EQ(reports, 2U);
}

TEST(ReadCloud, ReadsNothingOnceItShallStop) {
  const std::filesystem::path path = std::filesystem::temp_directory_path() / "stopped_cloud.xyz";
  std::ofstream(path) << testing::xyz_text(7);
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_THROW(read_cloud(path, {}, context), Error);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace landmarkdb
