#include "cli/values.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cli/usage_error.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::cli {
namespace {

using ::testing::HasSubstr;

constexpr const char* kIdentity = "1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1";

std::string message_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

TEST(ParseNumber, ReadsWhatAPersonTypes) {
  EXPECT_DOUBLE_EQ(parse_number("1.5", "--voxel"), 1.5);
  EXPECT_DOUBLE_EQ(parse_number("+2", "--voxel"), 2.0);
  EXPECT_DOUBLE_EQ(parse_number(" -3e-2 ", "--voxel"), -0.03);
}

TEST(ParseNumber, RefusesAnythingElse) {
  for (const char* text : {"", " ", "abc", "1.5m", "1,5", "nan", "inf", "1e999", "--1", "1 2"}) {
    EXPECT_THROW(parse_number(text, "--voxel"), UsageError) << '"' << text << '"';
  }
}

TEST(ParsePositive, RefusesZeroAndLess) {
  EXPECT_DOUBLE_EQ(parse_positive("0.01", "--voxel"), 0.01);
  EXPECT_THROW(parse_positive("0", "--voxel"), UsageError);
  EXPECT_THROW(parse_positive("-0.01", "--voxel"), UsageError);
}

TEST(ParseVector3, ReadsThreeNumbersBetweenCommas) {
  EXPECT_EQ(parse_vector3("1,-2.5,3e1", "--up"), Eigen::Vector3d(1, -2.5, 30));
  EXPECT_EQ(parse_vector3("1, 2, 3", "--up"), Eigen::Vector3d(1, 2, 3));
}

TEST(ParseVector3, RefusesTheWrongCount) {
  for (const char* text : {"", "1", "1,2", "1,2,3,4", "1,2,", ",1,2", "1 2 3", "1,2,nan"}) {
    EXPECT_THROW(parse_vector3(text, "--up"), UsageError) << '"' << text << '"';
  }
}

TEST(ParseVector3, NamesTheOptionAndTheText) {
  EXPECT_THAT(message_of([] { parse_vector3("1,2", "--viewpoint"); }),
              AllOf(HasSubstr("--viewpoint"), HasSubstr("\"1,2\"")));
}

TEST(ParseDirection, RefusesZero) {
  EXPECT_EQ(parse_direction("0,0,9.81", "--up"), Eigen::Vector3d(0, 0, 9.81));
  EXPECT_THROW(parse_direction("0,0,0", "--up"), UsageError);
}

TEST(ParseBox, ReadsItsTwoCorners) {
  const Box box = parse_box("0,-1,2,4.5,1,3", "--box");
  EXPECT_EQ(box.min_m, Eigen::Vector3d(0, -1, 2));
  EXPECT_EQ(box.max_m, Eigen::Vector3d(4.5, 1, 3));
}

TEST(ParseBox, RefusesAnEmptyBox) {
  EXPECT_THROW(parse_box("0,0,0,1,1,0", "--box"), UsageError);
  EXPECT_THROW(parse_box("0,0,0,1,-1,1", "--box"), UsageError);
  EXPECT_THROW(parse_box("0,0,0,1,1", "--box"), UsageError);
}

TEST(ParsePose, TakesSpacesLinesCommasBracketsAndComments) {
  const Eigen::Isometry3d T_a_b = parse_pose(
      "# a quarter turn about z\n[0,-1,0,2,\n1,0,0,3,\n0,0,1,4,  # lift\n0,0,0,1]\n", "pose.txt");
  EXPECT_EQ(T_a_b.translation(), Eigen::Vector3d(2, 3, 4));
  EXPECT_TRUE((T_a_b.linear() * Eigen::Vector3d::UnitX()).isApprox(Eigen::Vector3d::UnitY()));
}

TEST(ParsePose, SaysWhatIsWrongWithTheNumbers) {
  EXPECT_THAT(message_of([] { parse_pose("1 2 3", "p.txt"); }),
              AllOf(HasSubstr("p.txt"), HasSubstr("3 numbers"), HasSubstr("16")));
  EXPECT_THAT(message_of([] { parse_pose("1 0 zero", "p.txt"); }), HasSubstr("\"zero\""));
  // Twice the identity: no rigid motion.
  EXPECT_THAT(message_of([] { parse_pose("2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1", "p.txt"); }),
              HasSubstr("p.txt"));
}

TEST(ParsePose, IsBadInputNotWrongUsage) {
  for (const std::string& text : {std::string(),
                                  std::string("1 2 3"),
                                  kIdentity + std::string(" 7"),
                                  std::string("1 0 0 0 0 1 0 0 0 0 1 0 1 0 0 1")}) {
    try {
      parse_pose(text, "p.txt");
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    }
  }
}

class PoseFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::temp_directory_path() /
            ("landmarkdb_pose_" + std::to_string(::getpid()) + ".txt");
  }
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& text) { std::ofstream(path_) << text; }

  std::filesystem::path path_;
};

TEST_F(PoseFile, IsReadBack) {
  write(kIdentity);
  EXPECT_TRUE(read_pose_file(path_).matrix().isIdentity());
  EXPECT_TRUE(read_pose(path_.string()).matrix().isIdentity());
}

TEST_F(PoseFile, ThatIsMissingAFolderOrHugeIsRefused) {
  EXPECT_THROW(read_pose_file(path_), Error);
  EXPECT_THROW(read_pose_file(std::filesystem::temp_directory_path()), Error);
  write(std::string(1 << 20, ' '));
  EXPECT_THROW(read_pose_file(path_), Error);
}

TEST(ReadPose, TakesTheNumbersThemselves) {
  const Eigen::Isometry3d T_a_b = read_pose("1,0,0,5,0,1,0,6,0,0,1,7,0,0,0,1");
  EXPECT_EQ(T_a_b.translation(), Eigen::Vector3d(5, 6, 7));
}

}  // namespace
}  // namespace landmarkdb::cli
