#include "engine/servo/read_servo.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/support/servo_arms.hpp"

namespace landmarkdb {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

Json pose_json(const Eigen::Isometry3d& T) { return Json(to_row_major(T.matrix())); }

Json arm_file() {
  const Arm arm = testing::puma_560(2.0);
  Json file;
  file["name"] = "PUMA 560";
  for (const ArmJoint& joint : arm.joints) {
    file["joints"].push_back({{"a", joint.a_m},
                              {"alpha", joint.alpha_rad},
                              {"d", joint.d_m},
                              {"min", joint.min_rad},
                              {"max", joint.max_rad},
                              {"rate", joint.max_rate_rad_s}});
  }
  file["T_flange_camera"] = pose_json(arm.T_flange_camera);
  file["T_camera_object"] = pose_json(testing::wanted_pose());
  return file;
}

std::string refusal(const std::function<void(Json&)>& change) {
  Json file = arm_file();
  change(file);
  try {
    parse_servo(file.dump(), "arm.json");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    return error.what();
  }
  return "accepted";
}

TEST(ParseServo, ReadsAnArmAndFillsInWhatIsLeftOut) {
  const ServoFile file = parse_servo(arm_file().dump(), "arm.json");
  const Arm expected = testing::puma_560(2.0);
  const JointVector q = testing::puma_560_pose();
  EXPECT_EQ(file.name, "PUMA 560");
  EXPECT_THAT(camera_pose(file.options.arm, q),
              testing::PoseNear(camera_pose(expected, q), 1e-9, 1e-9));
  EXPECT_THAT(file.options.T_camera_object, testing::PoseNear(testing::wanted_pose(), 1e-9, 1e-9));
  EXPECT_EQ(file.options.arm.joints[1].max_rad, expected.joints[1].max_rad);
  EXPECT_EQ(file.options.arm.joints[1].max_rate_rad_s, 2.0);
  EXPECT_EQ(file.options.gain_per_s, 3.0);
  EXPECT_EQ(file.options.cycle_s, 0.08);
  EXPECT_EQ(file.options.delay_cycles, 0U);
  EXPECT_FALSE(file.symmetry_given);
  EXPECT_FALSE(file.q.has_value());
  ASSERT_EQ(file.options.secondary.size(), 1U);
  EXPECT_EQ(file.options.secondary[0].kind, SecondaryKind::kJointLimits);
}

TEST(ParseServo, ReadsEveryKey) {
  Json json = arm_file();
  json["q"] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  json["gain"] = 1.5;
  json["cycle_s"] = 0.04;
  json["delay_cycles"] = 2;
  json["hold_cycles"] = 3;
  json["symmetry"] = "c4";
  json["feed_forward"] = true;
  json["observer_memory"] = 0.9;
  json["secondary"] = {
      {{"task", "posture"}, {"gain", 1.0}, {"joints", {4, 6}}, {"angles", {0.5, -0.5}}},
      {{"task", "joint_limits"}, {"margin", 0.2}}};
  json["joints"][5]["min"] = nullptr;
  json["joints"][5]["max"] = nullptr;
  json["joints"][0]["offset"] = 0.25;
  const ServoFile file = parse_servo(json.dump(), "arm.json");
  EXPECT_EQ((*file.q)(5), 0.6);
  EXPECT_EQ(file.options.gain_per_s, 1.5);
  EXPECT_EQ(file.options.cycle_s, 0.04);
  EXPECT_EQ(file.options.delay_cycles, 2U);
  EXPECT_EQ(file.options.hold_cycles, 3U);
  EXPECT_TRUE(file.symmetry_given);
  EXPECT_EQ(to_string(file.options.symmetry), "c4");
  EXPECT_TRUE(file.options.feed_forward);
  EXPECT_EQ(file.options.observer_memory, 0.9);
  ASSERT_EQ(file.options.secondary.size(), 2U);
  EXPECT_EQ(file.options.secondary[0].joints, (std::vector<Eigen::Index>{3, 5}));
  EXPECT_EQ(file.options.secondary[0].posture_rad[1], -0.5);
  EXPECT_EQ(file.options.secondary[1].margin, 0.2);
  EXPECT_TRUE(std::isinf(file.options.arm.joints[5].max_rad));
  EXPECT_EQ(file.options.arm.joints[0].offset_rad, 0.25);
}

TEST(ParseServo, NamesTheKeyAtFault) {
  EXPECT_EQ(refusal([](Json&) {}), "accepted");
  const auto says = [](const std::function<void(Json&)>& change, const char* words) {
    EXPECT_THAT(refusal(change),
                ::testing::AllOf(::testing::StartsWith("arm.json: "), HasSubstr(words)));
  };
  says([](Json& j) { j.erase("T_flange_camera"); }, "has no T_flange_camera");
  says([](Json& j) { j.erase("joints"); }, "has no joints");
  says([](Json& j) { j["joints"] = Json::array(); }, "0 joints");
  says([](Json& j) { j["joints"][2].erase("min"); }, "joints[2]: has no min");
  says([](Json& j) { j["joints"][2]["alfa"] = 1; }, "joints[2]: does not know \"alfa\"");
  says([](Json& j) { j["joints"][3]["rate"] = "fast"; }, "joints[3]: rate is \"fast\"");
  says([](Json& j) { j["joints"][3]["rate"] = -1; }, "joint 4: its largest rate is -1");
  says([](Json& j) { j["joints"][1]["min"] = 9; }, "joint 2: its range is 9 to");
  says([](Json& j) { j["joints"][1] = 3; }, "joints[1]: is 3, want an object");
  says([](Json& j) { j["T_camera_object"].erase(0); }, "T_camera_object has 15 numbers, want 16");
  says([](Json& j) { j["T_camera_object"][0] = 7.0; },
       "T_camera_object: the 3x3 part of a pose is no rotation");
  says([](Json& j) { j["gains"] = 3; }, "does not know \"gains\"");
  says([](Json& j) { j["gain"] = 20; }, "want below 1");
  says([](Json& j) { j["gain"] = nullptr; }, "gain is null");
  says([](Json& j) { j["delay_cycles"] = 1.5; }, "delay_cycles is 1.5, want a whole number");
  says([](Json& j) { j["delay_cycles"] = 60; }, "delay_cycles is 60, want at most 50");
  says([](Json& j) { j["symmetry"] = "c1"; }, "symmetry is \"c1\"");
  says([](Json& j) { j["feed_forward"] = 1; }, "feed_forward is 1, want true or false");
  says([](Json& j) { j["q"] = {1, 2}; }, "2 joint angles");
  says([](Json& j) { j["secondary"] = {{{"task", "dance"}}}; }, "secondary[0]: task is \"dance\"");
  says(
      [](Json& j) {
        j["secondary"] = {{{"task", "posture"}, {"joints", {7}}, {"angles", {0}}}};
      },
      "secondary[0]: joints names one that the arm does not have, want 1 to 6");
}

TEST(ParseServo, RefusesWhatIsNoArmFileAtAll) {
  const auto refused = [](const std::string& text) {
    try {
      parse_servo(text, "arm.json");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refused(""), HasSubstr("is no JSON"));
  EXPECT_THAT(refused("[1, 2]"), HasSubstr("want an object"));
  EXPECT_THAT(refused("{\"joints\": "), HasSubstr("is no JSON"));
  EXPECT_THAT(refused(std::string(100, '[')), HasSubstr("nested too deeply"));
  EXPECT_THAT(refused(std::string(300'000, ' ')), HasSubstr("300000 bytes, want at most"));
  EXPECT_THAT(refused("{\"gain\": 1e999}"), HasSubstr("arm.json"));
}

TEST(ParseServo, ReadsTheExampleOfItsPage) {
  std::ifstream in(std::filesystem::path(LANDMARKDB_DOCS) / "servoing.md");
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  const std::string mark = "<!-- arm file -->\n```json\n";
  const std::size_t begin = page.find(mark);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t text = begin + mark.size();
  const ServoFile file =
      parse_servo(page.substr(text, page.find("```", text) - text), "the example");
  EXPECT_THAT(
      camera_pose(file.options.arm, testing::puma_560_pose()),
      testing::PoseNear(camera_pose(testing::puma_560(1.0), testing::puma_560_pose()), 1e-6, 1e-6));
  EXPECT_THAT(file.options.T_camera_object, testing::PoseNear(testing::wanted_pose(), 1e-6, 1e-6));
  EXPECT_EQ(file.q->size(), 6);
}

TEST(ReadServo, NamesTheFileThatCannotBeRead) {
  const auto path = std::filesystem::temp_directory_path() / "landmarkdb_read_servo_test.json";
  std::ofstream(path) << arm_file().dump(2);
  EXPECT_EQ(read_servo(path).options.arm.joints.size(), 6U);
  std::filesystem::remove(path);
  EXPECT_THROW(read_servo(path), Error);
  EXPECT_THROW(read_servo(std::filesystem::temp_directory_path()), Error);
}

}  // namespace
}  // namespace landmarkdb
