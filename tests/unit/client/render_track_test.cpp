#include "client/render_track.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace landmarkdb::client {
namespace {

TrackedFrame tracked() {
  TrackedFrame frame;
  frame.status = "tracked";
  frame.T_camera_object = Eigen::Isometry3d(Eigen::Translation3d(0.1, 0.2, 0.6) *
                                            Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  frame.rms_px = 0.4;
  frame.matched = 8;
  return frame;
}

TEST(RenderTrack, HasTheDocumentedKeysInTheirOrder) {
  const auto json = track_json("f1.png", tracked());
  const std::string text = json.dump();
  std::size_t last = 0;
  for (const char* key : {"frame",
                          "status",
                          "T_camera_object",
                          "translation_m",
                          "euler_zyx_deg",
                          "rms_px",
                          "matched",
                          "visible_points",
                          "edge_share",
                          "confidence",
                          "timing_ms"}) {
    const std::size_t at = text.find('"' + std::string(key) + "\":");
    EXPECT_NE(at, std::string::npos) << key;
    EXPECT_GE(at, last) << key;
    last = at;
  }
  EXPECT_EQ(json["frame"], "f1.png");
  EXPECT_NEAR(json["euler_zyx_deg"][0].get<double>(), 28.6479, 1e-3);
  EXPECT_EQ(json["T_camera_object"][11], 0.6);
  EXPECT_FALSE(json.contains("servo"));
  EXPECT_FALSE(json.contains("reason"));
}

TEST(RenderTrack, ALostFrameHasNoPoseButItsKeys) {
  TrackedFrame frame;
  frame.status = "lost";
  frame.reason = "nothing there";
  const auto json = track_json("f1.png", frame);
  EXPECT_EQ(json["reason"], "nothing there");
  for (const char* key : {"T_camera_object", "translation_m", "euler_zyx_deg"}) {
    ASSERT_TRUE(json.contains(key)) << key;
    EXPECT_TRUE(json[key].is_null()) << key;
  }
}

TEST(RenderTrack, HasWhatTheArmShouldDo) {
  TrackedFrame frame = tracked();
  frame.servo = ServoAnswer{.status = "running",
                            .twist = {1, 2, 3, 4, 5, 6},
                            .joint_rates_rad_s = {0.5},
                            .error = {0.25},
                            .rank = 6};
  const auto json = track_json("f1.png", frame)["servo"];
  EXPECT_EQ(json["status"], "running");
  EXPECT_EQ(json["twist"][5], 6.0);
  EXPECT_EQ(json["joint_rates"][0], 0.5);
  EXPECT_EQ(json["error"][0], 0.25);
  EXPECT_EQ(json["rank"], 6);
}

TEST(RenderTrack, AnUnusableFrameIsALineToo) {
  const auto json = unusable_frame_json("f1.png", "is empty");
  EXPECT_EQ(json["status"], "error");
  EXPECT_EQ(json["reason"], "is empty");
}

}  // namespace
}  // namespace landmarkdb::client
