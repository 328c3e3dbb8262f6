#include <array>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/integration/depth_png.hpp"
#include "tests/integration/site.hpp"
#include "tests/support/pose_near.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;
using ::testing::AnyOf;

constexpr double kNear_m = 0.05;
constexpr double kNear_rad = 2.0 * std::numbers::pi / 180.0;

TEST(Query, FindsWhereTheCameraStood) {
  ServerProcess server(site().db);
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE("view " + std::to_string(seed));
    const Eigen::Isometry3d T = make_view_pose(site().room, seed);
    const std::string cloud = site().view("view" + std::to_string(seed), site().room, T);
    const Outcome outcome = server.client({"--json", "query", cloud});
    ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    const json answer = outcome.json();
    EXPECT_EQ(answer["status"], "localized");
    EXPECT_EQ(answer["hypotheses"][0]["scene"], "room");
    EXPECT_THAT(matrix(answer["hypotheses"][0]["T_scene_sensor"]), PoseNear(T, kNear_m, kNear_rad));
  }
}

TEST(Query, FindsTwoViewsWithTheirPosesAsOne) {
  ServerProcess server(site().db);
  const std::array<Eigen::Isometry3d, 2> T{make_view_pose(site().room, 1),
                                           make_view_pose(site().room, 2)};
  std::vector<std::string> arguments{"--json", "query"};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string name = "set" + std::to_string(i);
    arguments.push_back(site().view(name, site().room, T[i]));
    const std::filesystem::path pose = site().folder / (name + ".txt");
    std::ofstream(pose) << std::setprecision(17)
                        << (T[0].inverse() * T[i]).matrix().format(Eigen::IOFormat(17)) << "\n";
    arguments.push_back("--pose");
    arguments.push_back(pose);
  }
  const Outcome outcome = server.client(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(matrix(outcome.json()["hypotheses"][0]["T_scene_sensor"]),
              PoseNear(T[0], kNear_m, kNear_rad));
}

TEST(Query, ChainMultipliesOutExactly) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const json answer =
      server.client({"--json", "query", site().view("chain", site().room, T)}).json();
  ASSERT_FALSE(answer["hypotheses"].empty());
  for (const json& h : answer["hypotheses"]) {
    const Eigen::Matrix4d product = matrix(h["chain"]["T_icp"]) *
                                    matrix(h["chain"]["T_scene_landmark"]) *
                                    matrix(h["chain"]["T_landmark_sensor"]);
    EXPECT_LE((product - matrix(h["T_scene_sensor"])).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_EQ(h["chain"]["scale"], 1.0);
  }
}

TEST(Query, NeverLocalizesACloudFromAnotherPlace) {
  ServerProcess server(site().db);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Eigen::Isometry3d T = make_view_pose(site().elsewhere, seed);
    const std::string cloud = site().view("other" + std::to_string(seed), site().elsewhere, T);
    const Outcome outcome = server.client({"--json", "query", cloud});
    EXPECT_THAT(outcome.status, AnyOf(3, 4)) << outcome.out << outcome.err;
    EXPECT_EQ(outcome.json()["status"], outcome.status == 3 ? "not_found" : "ambiguous");
    EXPECT_EQ(outcome.json().contains("reason"), outcome.status == 3);
  }
}

// The path of every leaf, with its type: what scripts rely on.
void collect(const json& value, const std::string& path, std::map<std::string, std::string>& out) {
  if (value.is_object()) {
    for (const auto& item : value.items()) collect(item.value(), path + "/" + item.key(), out);
  } else if (value.is_array()) {
    out[path] = value.empty() || value[0].is_number() ? "numbers" : "list";
    out[path + "#"] = std::to_string(value.size());
  } else {
    out[path] = value.is_number() ? "number" : value.type_name();
  }
}

TEST(Query, JsonHasEveryDocumentedKeyWithItsType) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const json answer =
      server.client({"--json", "query", site().view("schema", site().room, T)}).json();
  std::map<std::string, std::string> found;
  collect(answer["query"], "query", found);
  collect(answer["timing_ms"], "timing_ms", found);
  collect(answer["hypotheses"].at(0), "h", found);
  for (const char* key : {"h/confidence",
                          "h/chain/scale",
                          "h/correspondences/putative",
                          "h/correspondences/after_ratio",
                          "h/correspondences/after_slope",
                          "h/correspondences/after_consistency",
                          "h/correspondences/inliers",
                          "h/fit/overlap",
                          "h/fit/rmse_m",
                          "h/fit/free_space_violation",
                          "h/fit/margin",
                          "query/points",
                          "query/points_used",
                          "query/invalid",
                          "query/keypoints",
                          "query/density_ratio",
                          "query/seed",
                          "timing_ms/load",
                          "timing_ms/preprocess",
                          "timing_ms/keypoints",
                          "timing_ms/describe",
                          "timing_ms/match",
                          "timing_ms/filter",
                          "timing_ms/pose",
                          "timing_ms/icp",
                          "timing_ms/verify",
                          "timing_ms/total"}) {
    EXPECT_EQ(found[key], "number") << key;
  }
  EXPECT_EQ(found["h/scene"], "string");
  EXPECT_THAT(found["h/landmark"], AnyOf("string", "null"));
  const std::map<std::string, std::string> lengths = {{"h/T_scene_sensor", "16"},
                                                      {"h/translation_m", "3"},
                                                      {"h/rotation_xyzw", "4"},
                                                      {"h/roll_pitch_yaw_deg", "3"},
                                                      {"h/chain/T_landmark_sensor", "16"},
                                                      {"h/chain/T_scene_landmark", "16"},
                                                      {"h/chain/T_icp", "16"},
                                                      {"h/covariance", "36"}};
  for (const auto& [key, length] : lengths) {
    EXPECT_EQ(found[key], "numbers") << key;
    EXPECT_EQ(found[key + "#"], length) << key;
  }
  EXPECT_TRUE(answer["status"].is_string());
  EXPECT_TRUE(answer["warnings"].is_array());
  EXPECT_EQ(answer["query"]["points"], 160 * 120);
  EXPECT_GT(answer["timing_ms"]["total"].get<double>(), 0.0);
  EXPECT_GE(answer["hypotheses"][0]["confidence"].get<double>(), 0.5);
  EXPECT_LE(answer["hypotheses"][0]["confidence"].get<double>(), 1.0);
}

TEST(Query, AnswersTheSameForTheSameSeedWhateverTheThreads) {
  const Eigen::Isometry3d T = make_view_pose(site().room, 2);
  const std::string cloud = site().view("repeat", site().room, T);
  std::vector<json> answers;
  for (const char* threads : {"1", "2"}) {
    ServerProcess server(site().db, {"--threads", threads});
    for (int i = 0; i < 2; ++i) {
      answers.push_back(server.client({"--json", "query", cloud, "--seed", "7"}).json());
      answers.back().erase("timing_ms");
    }
  }
  EXPECT_EQ(answers[0]["query"]["seed"], 7);
  for (const json& answer : answers) EXPECT_EQ(answer, answers[0]);
}

TEST(Query, ReadsADepthImageWithItsCamera) {
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const ViewOptions options;
  const std::string image = site().folder / "depth.png";
  write_depth_png(image, view_of(site().room, T, options), 1000.0);
  const std::string camera = site().folder / "camera.json";
  std::ofstream(camera) << json{{"width", options.camera.width},
                                {"height", options.camera.height},
                                {"fx", options.camera.fx},
                                {"fy", options.camera.fy},
                                {"cx", options.camera.cx},
                                {"cy", options.camera.cy},
                                {"dist", {0, 0, 0, 0, 0}},
                                {"depth_scale", 1000.0}};
  ServerProcess server(site().db);
  const Outcome outcome = server.client({"--json", "query", image, "--camera", camera});
  ASSERT_EQ(outcome.status, 0) << outcome.out << outcome.err;
  EXPECT_THAT(matrix(outcome.json()["hypotheses"][0]["T_scene_sensor"]),
              PoseNear(T, kNear_m, kNear_rad));
}

TEST(Query, PrintsAFewReadableLinesWithoutJson) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const Outcome outcome = server.client({"query", site().view("text", site().room, T)});
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.out, ::testing::StartsWith("localized: scene room"));
  EXPECT_THAT(outcome.out, ::testing::HasSubstr("deg"));
  EXPECT_EQ(outcome.err, "");
}

TEST(Query, WritesEveryPairAndWhatDroppedIt) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const std::string csv = site().folder / "pairs.csv";
  const json answer =
      server
          .client(
              {"--json", "query", site().view("pairs", site().room, T), "--correspondences", csv})
          .json();
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  EXPECT_THAT(line, ::testing::StartsWith("scene,sensor_x_m"));
  std::size_t pairs = 0;
  std::size_t kept = 0;
  while (std::getline(file, line)) {
    ++pairs;
    kept += line.ends_with(',') ? 1 : 0;
  }
  const json& counts = answer["hypotheses"].at(0)["correspondences"];
  EXPECT_EQ(pairs, counts["putative"].get<std::size_t>());
  EXPECT_EQ(kept, counts["inliers"].get<std::size_t>());
}

TEST(Query, AsksOneSceneWherePeopleNameIt) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().room, 1);
  const std::string cloud = site().view("named", site().room, T);
  EXPECT_EQ(server.client({"query", cloud, "--scene", "room"}).status, 0);
  const Outcome unknown = server.client({"--json", "query", cloud, "--scene", "attic"});
  EXPECT_EQ(unknown.status, 3);
  EXPECT_EQ(unknown.json()["error"]["code"], "NOT_FOUND");
  EXPECT_THAT(unknown.out, ::testing::HasSubstr("attic"));
}

TEST(Query, ExplainsItsAnswerAndWritesAPageWhenAsked) {
  ServerProcess server(site().db);
  const Eigen::Isometry3d T = make_view_pose(site().elsewhere, 1);
  const std::string cloud = site().view("explained", site().elsewhere, T);
  const std::string page = site().folder / "page.html";
  const Outcome outcome = server.client({"--json", "query", cloud, "--explain", "--report", page});
  ASSERT_THAT(outcome.status, AnyOf(3, 4)) << outcome.err;
  const json explain = outcome.json()["explain"];
  EXPECT_EQ(explain["funnel"][0]["step"], "points");
  EXPECT_EQ(explain["funnel"][0]["left"], outcome.json()["query"]["points"]);
  EXPECT_FALSE(explain["candidates"].empty());
  EXPECT_TRUE(explain["lost_at"].is_string());
  std::ifstream file(page);
  const std::string html((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(html, ::testing::EndsWith("</html>\n"));
  EXPECT_FALSE(server.client({"--json", "query", cloud}).json().contains("explain"));
}

}  // namespace
}  // namespace landmarkdb::testing
