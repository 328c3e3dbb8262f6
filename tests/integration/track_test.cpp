// A model followed from its file to joint rates: indexer, server, client.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "datasets/mono/render_model.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/types/feature_names.hpp"
#include "tests/integration/site.hpp"
#include "tests/support/moving_box.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class Tracking : public ::testing::Test {
 protected:
  Tracking() {
    camera_file = write("camera.json",
                        R"({"width": 640, "height": 480, "fx": 600, "fy": 600, "cx": 320,
                            "cy": 240, "dist": [-0.15, 0, 0, 0, 0]})");
    const std::string model = std::string(LANDMARKDB_SOURCE) + "/datasets/models/box.json";
    const Outcome added = run("landmarkdb-indexer", {"--db", db, "model", "add", "box", model});
    EXPECT_EQ(added.status, 0) << added.out << added.err;
    server.emplace(db);
  }

  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    return folder / name;
  }

  // Frames 1 to `count` as images in a folder of their own.
  std::string video(int count) const {
    std::filesystem::create_directory(folder / "video");
    for (int frame = 1; frame <= count; ++frame) {
      const GreyImage image =
          datasets::render_model(box.record->model, box.camera, box.T_camera_object(frame), {});
      std::string pgm = "P5\n640 480\n255\n";
      pgm.append(image.pixels.begin(), image.pixels.end());
      write("video/f" + std::to_string(frame) + ".pgm", pgm);
    }
    return folder / "video";
  }

  json points_of(int frame) const {
    const ImageFeatures features = box.features(frame);
    json points = json::array();
    for (const ImageFeature& feature : features.points) {
      points.push_back(
          {{"type", feature_type_name(feature.type)}, {"uv", {feature.uv.x(), feature.uv.y()}}});
    }
    return {{"frame", frame}, {"points", points}, {"links", features.links}};
  }

  Outcome track(const std::string& source, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"track", source, "--camera", camera_file, "--model", "box"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return server->client(arguments);
  }

  static std::vector<json> lines_of(const Outcome& outcome) {
    std::vector<json> lines;
    std::istringstream text(outcome.out);
    for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line));
    return lines;
  }

  void expect_truth(const json& line, int frame, double metres, double radians) const {
    const Eigen::Matrix4d T = matrix(line["T_camera_object"]);
    const Eigen::Isometry3d truth = box.T_camera_object(frame);
    EXPECT_LT((T.topRightCorner<3, 1>() - truth.translation()).norm(), metres) << line;
    EXPECT_LT(rotation_angle_rad(T.topLeftCorner<3, 3>().transpose() * truth.linear()), radians)
        << line;
  }

  MovingBox box;
  TempFolder folder;
  std::string db = folder / "models.db";
  std::string camera_file;
  std::optional<ServerProcess> server;
};

TEST_F(Tracking, FollowsTheBoxThroughAFolderOfImages) {
  constexpr int kFrames = 12;  // two digits: f2 comes before f10
  const Outcome outcome = track(video(kFrames));
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  const std::vector<json> lines = lines_of(outcome);
  ASSERT_THAT(lines, SizeIs(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const json& line = lines[static_cast<std::size_t>(i)];
    EXPECT_THAT(line["frame"].get<std::string>(), HasSubstr("/f" + std::to_string(i + 1) + ".pgm"));
    EXPECT_EQ(line["status"], i == 0 ? "recognized" : "tracked");
    expect_truth(line, i + 1, 2e-3, 0.01);
    EXPECT_GT(line["edge_share"], 0.7);
    EXPECT_GT(line["confidence"], 0.5);
    EXPECT_FALSE(line.contains("servo"));
  }
  const json stats = server->client({"--json", "stats"}).json();
  EXPECT_EQ(stats["track_frames"], kFrames);
  EXPECT_EQ(stats["tracks_open"], 0);
}

TEST_F(Tracking, FollowsPointsAndLeadsAnArm) {
  std::string text;
  for (int frame = 0; frame < 6; ++frame) text += points_of(frame).dump() + '\n';
  const std::string points = write("points.jsonl", text);
  const std::string arm = write("arm.json", arm_file(box, 5));
  const std::vector<json> plain = lines_of(track(points));
  const Outcome outcome = track(points, {"--servo", arm});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const std::vector<json> lines = lines_of(outcome);
  ASSERT_THAT(lines, SizeIs(6));
  double last_rad = 1.0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i]["frame"], std::to_string(i));
    expect_truth(lines[i], static_cast<int>(i), 1e-4, 1e-3);
    EXPECT_EQ(lines[i]["T_camera_object"], plain[i]["T_camera_object"]) << "same frames";
    const json& servo = lines[i]["servo"];
    EXPECT_EQ(servo["status"], "running");
    EXPECT_EQ(servo["rank"], 6);
    EXPECT_EQ(servo["twist"].size(), 6U);
    EXPECT_EQ(servo["joint_rates"].size(), 6U);
    EXPECT_EQ(servo["error"].size(), 6U);
    EXPECT_LT(servo["rotation_rad"], last_rad) << "the box comes to where it should be seen";
    last_rad = servo["rotation_rad"];
  }
  EXPECT_LT(last_rad, 1e-3);
}

TEST_F(Tracking, ImagesLeadAnArmToo) {
  const std::string arm = write("arm.json", arm_file(box, 1));
  const std::vector<json> lines = lines_of(track(video(1) + "/*.pgm", {"--servo", arm}));
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_LT(lines[0]["servo"]["rotation_rad"], 0.01);
}

TEST_F(Tracking, BadFramesAreToldAndTheOthersFollowed) {
  const std::string points =
      write("points.jsonl", points_of(0).dump() + "\n{\n" + points_of(1).dump() + '\n');
  const Outcome some = track(points);
  EXPECT_EQ(some.status, 0) << some.err;
  const std::vector<json> lines = lines_of(some);
  ASSERT_THAT(lines, SizeIs(3));
  EXPECT_EQ(lines[1]["status"], "error");
  EXPECT_THAT(lines[1]["reason"].get<std::string>(), HasSubstr("line 2"));
  EXPECT_EQ(lines[2]["status"], "tracked");
  EXPECT_EQ(track(write("broken.jsonl", "{\n")).status, 7);
  EXPECT_EQ(track(write("small.pgm", "P5\n2 2\n255\nabcd")).status, 7);
}

TEST_F(Tracking, NothingSeenIsStatusThree) {
  const Outcome outcome = track(write("empty.jsonl", "{\"points\": []}\n{\"points\": []}\n"));
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  for (const json& line : lines_of(outcome)) {
    EXPECT_EQ(line["status"], "lost");
    EXPECT_TRUE(line["T_camera_object"].is_null());
  }
}

TEST_F(Tracking, WrongArgumentsAreToldBeforeAnyFrame) {
  const std::string points = write("points.jsonl", points_of(0).dump() + '\n');
  EXPECT_EQ(server->client({"track", points, "--camera", camera_file, "--model", "cup"}).status, 3);
  EXPECT_EQ(server->client({"track", points, "--camera", camera_file}).status, 2);
  EXPECT_EQ(track(folder / "nowhere").status, 7);
  const Outcome arm = track(points, {"--servo", write("arm.json", R"({"joint": []})")});
  EXPECT_EQ(arm.status, 7);
  EXPECT_THAT(arm.err, HasSubstr("arm.json"));
  EXPECT_THAT(arm.err, HasSubstr("joint"));
  EXPECT_EQ(track(points, {"--servo", write("none.json", "")}).status, 7);
}

TEST_F(Tracking, AnInterruptEndsItWhileItWaitsForFrames) {
  // A pipe that nobody writes to.
  const std::string pipe = folder / "frames.jsonl";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::fstream keep_open(pipe, std::ios::in | std::ios::out);
  Running client(
      "landmarkdb",
      {"--server", server->address(), "track", pipe, "--camera", camera_file, "--model", "box"});
  while (server->client({"--json", "stats"}).json()["tracks_open"] != 1) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  client.signal(SIGINT);
  EXPECT_EQ(client.wait().status, 130);
  while (server->client({"--json", "stats"}).json()["tracks_open"] != 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace
}  // namespace landmarkdb::testing
