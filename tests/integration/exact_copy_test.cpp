// Where a place exists twice, no cloud says in which of the two it was taken, and the answer must
// not either.

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb::testing {
namespace {

using datasets::DepthFrame;
using datasets::Place;

constexpr double kNear_m = 0.10;  // what counts as right
constexpr double kNear_rad = 0.087;
constexpr std::size_t kFrames = 6;

Place corridor(std::uint64_t seed) {
  return datasets::make_place({.type = datasets::PlaceType::kCorridor,
                               .seed = seed,
                               .size = 0.4,
                               .floors = 1,
                               .stations = 2});
}

PointCloud scan_of(const Place& place) {
  datasets::ScannerOptions options;
  options.points = 80'000;
  return datasets::merge_stations(datasets::scan_place(place, options, {}));
}

std::vector<DepthFrame> frames_in(const Place& place, std::uint64_t seed) {
  datasets::DepthCameraOptions camera;
  camera.camera = {.width = 160, .height = 120, .fx = 131, .fy = 131, .cx = 79.5, .cy = 59.5};
  std::vector<DepthFrame> frames;
  for (const Eigen::Isometry3d& T : datasets::sample_camera_poses(place, kFrames, seed)) {
    camera.seed = seed + frames.size();
    frames.push_back(datasets::render_depth(place, T, camera, {}));
  }
  return frames;
}

std::string told(const QueryResult& answer) {
  std::ostringstream out;
  out << answer.reason << '\n';
  for (const Hypothesis& h : answer.hypotheses) {
    out << h.scene << " confidence " << h.confidence << " quality " << h.fit.quality << " at "
        << h.T_scene_sensor.topRightCorner<3, 1>().transpose() << '\n';
  }
  return out.str();
}

bool lists(const QueryResult& answer, const std::string& scene, const Eigen::Isometry3d& T) {
  for (const Hypothesis& h : answer.hypotheses) {
    if (h.scene != scene) continue;
    if (::testing::Value(h.T_scene_sensor, PoseNear(T, kNear_m, kNear_rad))) return true;
  }
  return false;
}

class ExactCopy : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(ExactCopy, OfACorridorIsAmbiguousWithBothPosesListed) {
  const Place place = corridor(GetParam());
  IndexOptions upright;
  upright.up = Eigen::Vector3d::UnitZ();
  const SceneRecord record = describe("corridor", scan_of(place), upright);
  SceneRecord copy = record;
  copy.name = "copy";
  const auto alone = localizer_of({record});
  const auto both = localizer_of({record, copy});
  int localized = 0;
  for (const DepthFrame& frame : frames_in(place, GetParam())) {
    const Eigen::Isometry3d& T = frame.T_scene_camera;
    const QueryResult answer = both->query(frame.cloud, {}, {});
    EXPECT_NE(answer.status, QueryStatus::kLocalized) << told(answer);
    // Bare walls are declined by right; what one corridor places must be ambiguous between two.
    if (alone->query(frame.cloud, {}, {}).status != QueryStatus::kLocalized) continue;
    ++localized;
    EXPECT_EQ(answer.status, QueryStatus::kAmbiguous) << told(answer);
    EXPECT_TRUE(lists(answer, "corridor", T)) << told(answer);
    EXPECT_TRUE(lists(answer, "copy", T)) << told(answer);
  }
  EXPECT_GE(localized, 1);  // else nothing was tried
}

INSTANTIATE_TEST_SUITE_P(Corridors, ExactCopy, ::testing::Values(1, 2, 3));

}  // namespace
}  // namespace landmarkdb::testing
