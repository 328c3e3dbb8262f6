// Recorded places of real sensors, all in one database, and every recorded view asked against it.
// The data is not part of the project: the environment variable LANDMARKDB_REAL_DATA names its
// folder (database.json, cases.json, clouds/).

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "engine/cloud/read_cloud.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/integration/site.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;

constexpr double kRight_m = 0.10;
constexpr double kRight_deg = 5.0;

json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  return json::parse(file);
}

std::string scene_name(const std::string& cloud) {
  return std::filesystem::path(cloud).stem().string();
}

// Of the finite points: where positions are compared, as a far origin would magnify the rotation.
Eigen::Vector3d centre_of(const PointCloud& cloud) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const Eigen::Vector3f& point : cloud.points) {
    if (!point.allFinite()) continue;
    sum += point.cast<double>();
    count += 1.0;
  }
  return cloud.origin + sum / count;
}

struct Judged {
  std::string status;
  std::string scene = "-";
  bool right = false;
  double error_m = NAN;
  double error_deg = NAN;
  double confidence = NAN;
  double total_ms = NAN;
};

Judged judge(const json& one, const json& answer, const Eigen::Vector3d& centre) {
  Judged out;
  out.status = answer["status"];
  out.total_ms = answer["timing_ms"]["total"];
  if (answer["hypotheses"].empty()) return out;
  const json& best = answer["hypotheses"][0];
  out.scene = best["scene"];
  out.confidence = best["confidence"];
  if (one["target"].empty() || out.scene != scene_name(one["target"][0])) return out;
  const Eigen::Matrix4d truth = matrix(one["T_target_query"]);
  const Eigen::Matrix4d found = matrix(best["T_scene_sensor"]);
  out.error_m = ((found - truth) * centre.homogeneous()).norm();
  out.error_deg = rotation_angle_rad(nearest_rotation(found.topLeftCorner<3, 3>()) *
                                     nearest_rotation(truth.topLeftCorner<3, 3>()).transpose()) *
                  180.0 / std::numbers::pi;
  out.right = out.error_m <= std::max(kRight_m, one["truth_accuracy_m"].get<double>()) &&
              out.error_deg <= std::max(kRight_deg, one["truth_accuracy_deg"].get<double>());
  return out;
}

void index_places(const std::filesystem::path& data, const std::string& db) {
  const json places = read_json(data / "database.json")["scene"];
  for (const json& place : places) {
    const std::string cloud = place;
    const Outcome outcome =
        run("landmarkdb-indexer", {"--db", db, "add", scene_name(cloud), (data / cloud).string()});
    ASSERT_EQ(outcome.status, 0) << cloud << ": " << outcome.err;
    std::printf("%s", outcome.out.c_str());
  }
}

TEST(RealData, NoAnswerIsConfidentlyWrong) {
  const char* folder = std::getenv("LANDMARKDB_REAL_DATA");
  if (folder == nullptr || *folder == '\0') {
    GTEST_SKIP() << "LANDMARKDB_REAL_DATA names no folder with the recorded places";
  }
  const std::filesystem::path data = folder;
  const TempFolder temporary;
  const std::string db = temporary / "real.db";
  ASSERT_NO_FATAL_FAILURE(index_places(data, db));
  ServerProcess server(db);
  int cases = 0;
  int located = 0;
  std::printf("%-22s %-10s %-14s %8s %7s %5s %7s\n",
              "case",
              "status",
              "scene",
              "error m",
              "deg",
              "conf",
              "ms");
  for (const json& one : read_json(data / "cases.json")) {
    if (one["kind"] != "scene") continue;
    const std::string query = (data / one["query"].get<std::string>()).string();
    const Outcome outcome = server.client({"--json", "query", query});
    ASSERT_TRUE(outcome.status == 0 || outcome.status == 3 || outcome.status == 4)
        << one["id"] << ": " << outcome.out << outcome.err;
    const Judged judged = judge(one, outcome.json(), centre_of(read_cloud(query, {})));
    std::printf("%-22s %-10s %-14s %8.3f %7.2f %5.2f %7.0f%s\n",
                one["id"].get<std::string>().c_str(),
                judged.status.c_str(),
                judged.scene.c_str(),
                judged.error_m,
                judged.error_deg,
                judged.confidence,
                judged.total_ms,
                judged.status == "localized" && !judged.right ? "  WRONG" : "");
    EXPECT_TRUE(judged.status != "localized" || judged.right) << one["id"];
    if (!one["target"].empty()) {
      ++cases;
      located += judged.status == "localized" && judged.right ? 1 : 0;
    }
  }
  std::printf("localized and right: %d of %d\n", located, cases);
  EXPECT_GT(located, 0);
}

}  // namespace
}  // namespace landmarkdb::testing
