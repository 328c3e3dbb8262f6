#include "datasets/place_files.hpp"

#include <fstream>
#include <map>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "engine/base/error.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb::datasets {
namespace {

namespace fs = std::filesystem;

class WritePlaceSet : public ::testing::Test {
 protected:
  WritePlaceSet()
      : folder_(fs::temp_directory_path() / ("landmarkdb-datasets-" + std::to_string(getpid()))) {
    options_.scanner.points = 5'000;
    options_.queries = 2;
    options_.camera.camera = {
        .width = 160, .height = 120, .fx = 131, .fy = 131, .cx = 79.5, .cy = 59.5};
  }
  ~WritePlaceSet() override { fs::remove_all(folder_); }

  // Every file's bytes by its name.
  std::map<std::string, std::string> write(const std::string& name, int threads) {
    RunContext context;
    context.threads = threads;
    set_ = write_place_set(place_, folder_ / name, options_, context);
    std::map<std::string, std::string> files;
    for (const auto& entry : fs::directory_iterator(folder_ / name)) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::stringstream bytes;
      bytes << in.rdbuf();
      files[entry.path().filename().string()] = bytes.str();
    }
    return files;
  }

  fs::path folder_;
  Place place_ = make_place({.type = PlaceType::kOffice, .seed = 2, .size = 0.5, .stations = 2});
  SetOptions options_;
  PlaceSet set_;
};

TEST_F(WritePlaceSet, WritesTheSameBytesEachTimeWhateverTheThreads) {
  const auto once = write("a", 1);
  const auto again = write("b", 3);
  ASSERT_EQ(once.size(), again.size());
  for (const auto& [name, bytes] : once) EXPECT_EQ(bytes, again.at(name)) << name;
}

TEST_F(WritePlaceSet, WritesWhatItsManifestLists) {
  options_.query_points = 4'097;
  const auto files = write("a", 1);
  EXPECT_EQ(set_.points, 5'000U);
  EXPECT_EQ(set_.queries, 2U);
  EXPECT_THAT(set_.index_command, ::testing::HasSubstr("station-01.ply"));
  const auto manifest = nlohmann::json::parse(files.at("manifest.json"));
  EXPECT_EQ(manifest.at("stations").size(), 2U);
  for (const auto& query : manifest.at("queries")) {
    const PointCloud cloud = read_cloud(folder_ / "a" / query.at("cloud").get<std::string>(), {});
    EXPECT_EQ(cloud.size(), 4'097U);
  }
}

TEST_F(WritePlaceSet, TellsTruthsThatHold) {
  options_.camera.noise_scale = 0.0;
  options_.camera.quantise = false;
  const auto files = write("a", 1);
  const auto truth = nlohmann::json::parse(files.at("query-001.truth.json"));
  const Eigen::Isometry3d T =
      from_row_major(truth.at("T_scene_sensor").get<std::array<double, 16>>());
  const Eigen::Vector3f eye = T.translation().cast<float>();
  const PointCloud cloud = read_cloud(folder_ / "a" / "query-001.ply", {});
  for (const Eigen::Vector3f& p : cloud.points) {
    const Eigen::Vector3f q = (T * p.cast<double>()).cast<float>();
    const auto hit = place_.caster->first_hit(eye, (q - eye).normalized(), 100.0F);
    ASSERT_TRUE(hit);
    ASSERT_NEAR(hit->distance_m, (q - eye).norm(), 0.002);
  }
}

TEST_F(WritePlaceSet, CanBeReadBackInTheSceneFrame) {
  write("a", 1);
  const PointCloud cloud = read_place_set(folder_ / "a");
  ASSERT_EQ(cloud.size(), 5'000U);
  int on_floor = 0;
  for (const Eigen::Vector3f& p : cloud.points) {
    if (std::abs(p.z() + cloud.origin.z()) < 0.03) ++on_floor;
  }
  EXPECT_GT(on_floor, 200);
}

TEST_F(WritePlaceSet, KeepsDepthFramesOrganisedWhenAsked) {
  options_.organised = true;
  write("a", 1);
  const PointCloud cloud = read_cloud(folder_ / "a" / "query-000.pcd", {});
  EXPECT_EQ(cloud.width, 160U);
  EXPECT_EQ(cloud.height, 120U);
}

TEST_F(WritePlaceSet, TakesQueriesWithALaserToo) {
  options_.sensor = QuerySensor::kLidar;
  options_.lidar.columns = 360;
  write("a", 1);
  EXPECT_GT(read_cloud(folder_ / "a" / "query-000.ply", {}).size(), 2'000U);
}

TEST_F(WritePlaceSet, SaysWhenNoFrameSeesEnough) {
  options_.query_points = 160 * 120 + 1;
  EXPECT_THROW(write("a", 1), Error);
}

TEST_F(WritePlaceSet, RefusesAFolderThatCannotBe) {
  EXPECT_THROW(write_place_set(place_, "/dev/null/set", options_, {}), Error);
}

TEST(ReadPlaceSet, RefusesAFolderWithoutAManifest) {
  EXPECT_THROW(read_place_set("/nowhere/at/all"), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
