// What a place or a cloud is written in (units, coordinates, order of points, which way round the
// sensor was held) does not change the answer.

#include <cstdint>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "engine/base/random.hpp"
#include "engine/cloud/write_cloud.hpp"
#include "tests/integration/site.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb::testing {
namespace {

using nlohmann::json;

constexpr double kRight_m = 0.05;
constexpr double kRight_rad = 2.0 * std::numbers::pi / 180.0;
// Equal answers: other floats meet other voxels, so not the same bits; but far nearer to each other
// than to the truth.
constexpr double kEqual_m = 0.005;
constexpr double kEqual_rad = 0.2 * std::numbers::pi / 180.0;

// Easting, northing and height, as surveys give them.
const Eigen::Vector3d kSurvey_m(500'000.0, 5'400'000.0, 300.0);

Eigen::Isometry3d shift(const Eigen::Vector3d& by_m) {
  return Eigen::Isometry3d(Eigen::Translation3d(by_m));
}

std::string text(const Eigen::Vector3d& v) {
  std::ostringstream out;
  out.precision(12);
  out << v.x() << ',' << v.y() << ',' << v.z();
  return out.str();
}

PointCloud in_millimetres(PointCloud cloud) {
  for (Eigen::Vector3f& p : cloud.points) p *= 1000.0F;
  for (Eigen::Vector3f& v : cloud.viewpoints) v *= 1000.0F;
  return cloud;
}

PointCloud shuffled(PointCloud cloud) {
  Random random(5);
  cloud.width = cloud.height = 0;
  for (std::size_t i = cloud.size(); i > 1; --i) {
    const std::size_t other = random.below(i);
    std::swap(cloud.points[i - 1], cloud.points[other]);
    if (cloud.viewpoint_index.empty()) continue;
    std::swap(cloud.viewpoint_index[i - 1], cloud.viewpoint_index[other]);
  }
  return cloud;
}

// The same scan around an origin of its own; its points stay the floats that they are.
PointCloud surveyed(PointCloud cloud) {
  cloud.origin = kSurvey_m;
  return cloud;
}

// A stored room, and frames that are localized in it.
class SamePose : public ::testing::Test {
 protected:
  struct View {
    Eigen::Isometry3d T_scene_sensor;
    Eigen::Vector3d up_sensor;
    PointCloud cloud;
    std::string file;
  };

  SamePose() {
    for (const std::uint64_t seed : {1, 2, 3}) {
      const Frame frame = frame_in(room_, seed);
      const std::string file = write("view" + std::to_string(seed) + ".ply", frame.cloud);
      views_.push_back({frame.T_scene_sensor, frame.up_sensor, frame.cloud, file});
    }
    add("plain", {write("plain.ply", room_.cloud)});
  }

  std::string write(const std::string& name, const PointCloud& cloud) const {
    write_cloud(folder_ / name, cloud);
    return folder_ / name;
  }

  void add(const std::string& name, const std::vector<std::string>& arguments) const {
    std::vector<std::string> all = {"--db", db_, "add", name};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const Outcome indexed = run("landmarkdb-indexer", all);
    if (indexed.status != 0) throw std::runtime_error(indexed.out + indexed.err);
  }

  // Where the cloud was taken; a failure where it is not localized.
  static Eigen::Matrix4d ask(const ServerProcess& server,
                             const std::string& scene,
                             const std::string& file,
                             const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"--json", "query", file, "--scene", scene};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = server.client(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.out << outcome.err;
    return matrix(outcome.json()["hypotheses"].at(0)["T_scene_sensor"]);
  }

  // The poses of the views in the plain scene, which are right.
  std::vector<Eigen::Isometry3d> plain_poses(const ServerProcess& server,
                                             const std::vector<std::string>& more = {}) const {
    std::vector<Eigen::Isometry3d> poses;
    for (const View& view : views_) {
      poses.emplace_back(ask(server, "plain", view.file, more));
      EXPECT_THAT(poses.back(), PoseNear(view.T_scene_sensor, kRight_m, kRight_rad));
    }
    return poses;
  }

  // The scene `name` answers as the plain one, `by_m` further.
  void expect_same_scene(const std::string& name,
                         const Eigen::Vector3d& by_m = Eigen::Vector3d::Zero()) const {
    const ServerProcess server(db_);
    const std::vector<Eigen::Isometry3d> plain = plain_poses(server);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const Eigen::Matrix4d T = ask(server, name, views_[i].file);
      EXPECT_THAT(shift(-by_m).matrix() * T, PoseNear(plain[i], kEqual_m, kEqual_rad)) << i;
    }
  }

  TempFolder folder_;
  std::string db_ = folder_ / "places.db";
  SyntheticScene room_ = small_room(2);
  std::vector<View> views_;
};

TEST_F(SamePose, InAPlaceGivenInMillimetres) {
  add("millimetres", {write("mm.ply", in_millimetres(room_.cloud)), "--units", "mm"});
  expect_same_scene("millimetres");
}

TEST_F(SamePose, InAPlaceInSurveyCoordinates) {
  add("surveyed", {write("surveyed.ply", surveyed(room_.cloud))});
  expect_same_scene("surveyed", kSurvey_m);
}

TEST_F(SamePose, InAPlaceInSurveyCoordinatesAsText) {
  std::vector<std::string> arguments;
  for (const PointCloud& scan : room_.scans) {
    arguments.push_back(folder_ / ("scan" + std::to_string(arguments.size()) + ".xyz"));
    std::ofstream out(arguments.back());
    out.precision(12);  // a northing to the hundredth of a millimetre
    for (const Eigen::Vector3f& p : scan.points) {
      const Eigen::Vector3d there = kSurvey_m + p.cast<double>();
      out << there.x() << ' ' << there.y() << ' ' << there.z() << '\n';
    }
  }
  for (const PointCloud& scan : room_.scans) {
    arguments.emplace_back("--viewpoint");
    arguments.push_back(text(kSurvey_m + scan.viewpoints.front().cast<double>()));
  }
  add("text", arguments);
  expect_same_scene("text", kSurvey_m);
}

TEST_F(SamePose, InAPlaceWhosePointsAreShuffled) {
  add("shuffled", {write("shuffled.ply", shuffled(room_.cloud))});
  expect_same_scene("shuffled");
}

TEST_F(SamePose, OfACloudWhosePointsAreShuffled) {
  const ServerProcess server(db_);
  const std::vector<Eigen::Isometry3d> plain = plain_poses(server);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const std::string file = write("shuffled.ply", shuffled(views_[i].cloud));
    EXPECT_THAT(ask(server, "plain", file), PoseNear(plain[i], kEqual_m, kEqual_rad)) << i;
  }
}

TEST_F(SamePose, OfACloudInMillimetres) {
  const ServerProcess server(db_);
  const std::vector<Eigen::Isometry3d> plain = plain_poses(server);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const std::string file = write("mm.ply", in_millimetres(views_[i].cloud));
    EXPECT_THAT(ask(server, "plain", file, {"--units", "mm"}),
                PoseNear(plain[i], kEqual_m, kEqual_rad))
        << i;
  }
}

TEST_F(SamePose, OfACloudWithAFewPointsFarOff) {
  const ServerProcess server(db_);
  const std::vector<Eigen::Isometry3d> plain = plain_poses(server);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    PointCloud cloud = views_[i].cloud;
    cloud.width = cloud.height = 0;
    Random random(i);
    const auto anywhere = [&](double within_m) {
      Eigen::Vector3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = random.uniform(-within_m, within_m);
      return p;
    };
    for (const double away_m : {100.0, 300.0, 1000.0, 5000.0, 20'000.0}) {
      cloud.points.push_back(anywhere(away_m).cast<float>());
    }
    for (int k = 0; k < 12; ++k) {  // a flock of birds
      cloud.points.push_back((Eigen::Vector3d(80, 120, 100) + anywhere(0.5)).cast<float>());
    }
    cloud.normals.clear();
    cloud.colours.clear();
    cloud.viewpoint_index.clear();
    EXPECT_THAT(ask(server, "plain", write("far.ply", cloud)),
                PoseNear(plain[i], kEqual_m, kEqual_rad))
        << i;
  }
}

TEST_F(SamePose, OfASensorHeldUpsideDownWithAndWithoutGravity) {
  const Eigen::Isometry3d T_turned_sensor(
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitZ()));
  const ServerProcess server(db_);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const std::string file = write("turned.ply", moved(views_[i].cloud, T_turned_sensor));
    for (const bool gravity : {false, true}) {
      SCOPED_TRACE(std::to_string(i) + (gravity ? " with gravity" : " without gravity"));
      std::vector<std::string> up, up_turned;
      if (gravity) {
        up = {"--up", text(views_[i].up_sensor)};
        up_turned = {"--up", text(T_turned_sensor.linear() * views_[i].up_sensor)};
      }
      const Eigen::Matrix4d plain = ask(server, "plain", views_[i].file, up);
      EXPECT_THAT(plain, PoseNear(views_[i].T_scene_sensor, kRight_m, kRight_rad));
      const Eigen::Matrix4d turned = ask(server, "plain", file, up_turned);
      EXPECT_THAT(turned * T_turned_sensor.matrix(),
                  PoseNear(Eigen::Isometry3d(plain), kEqual_m, kEqual_rad));
    }
  }
}

TEST_F(SamePose, OfACloudInCoordinatesOfItsOwn) {
  // A registered scan is asked about as it is: far from zero, its viewpoint in the file or named.
  add("surveyed", {write("surveyed.ply", surveyed(room_.cloud))});
  const ServerProcess server(db_);
  const std::vector<Eigen::Isometry3d> plain = plain_poses(server);
  for (std::size_t i = 0; i < views_.size(); ++i) {
    for (const char* name : {"own.ply", "own.pcd"}) {
      const std::string with_viewpoint = write(name, surveyed(views_[i].cloud));
      const Eigen::Matrix4d T_own = ask(server, "plain", with_viewpoint);
      EXPECT_THAT(T_own * shift(kSurvey_m).matrix(), PoseNear(plain[i], kEqual_m, kEqual_rad))
          << i << ' ' << name;
    }
    PointCloud bare = surveyed(views_[i].cloud);
    bare.viewpoints.clear();
    const std::string without = write("bare.ply", bare);
    const Eigen::Matrix4d T_both =
        ask(server, "surveyed", without, {"--viewpoint", text(kSurvey_m)});
    EXPECT_THAT(shift(-kSurvey_m).matrix() * T_both * shift(kSurvey_m).matrix(),
                PoseNear(plain[i], kEqual_m, kEqual_rad))
        << i;
  }
}

}  // namespace
}  // namespace landmarkdb::testing
