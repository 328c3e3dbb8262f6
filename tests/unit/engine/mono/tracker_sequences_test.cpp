// Sequences of Debian's package visp-images-data; skipped where it is not installed.

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "engine/geometry/pose.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/read_image.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/recognizer.hpp"
#include "engine/mono/search_model.hpp"
#include "engine/mono/tracker.hpp"

namespace landmarkdb {
namespace {

namespace fs = std::filesystem;
constexpr double kDegree = std::numbers::pi / 180.0;
const fs::path kData = "/usr/share/visp-images-data/ViSP-images";

std::shared_ptr<const MonoModelRecord> record_of(const fs::path& file) {
  auto record = std::make_shared<MonoModelRecord>();
  record->model = read_model(file, {}).model;
  record->triples = make_triples(record->model);
  return record;
}

std::string numbered(const char* format, int number) {
  char name[64];
  std::snprintf(name, sizeof(name), format, number);
  return name;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Eigen::Isometry3d castle_truth(int frame) {
  std::ifstream in(kData / "mbt-depth/Castle-simu/CameraPose" / numbered("Camera_%03d.txt", frame));
  std::array<double, 16> numbers{};
  for (double& number : numbers) in >> number;
  return from_row_major(numbers);
}

TEST(TrackerSequences, TheRenderedCastleIsFoundFromNothingAndFollowedThroughAllItsFrames) {
  const fs::path folder = kData / "mbt-depth/Castle-simu";
  if (!fs::exists(folder)) GTEST_SKIP() << "visp-images-data is not installed";
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 700.0;
  // The renderer's image centre is (320, 240) counted from the corner of a pixel; we count from
  // its middle.
  camera.cx = 319.5;
  camera.cy = 239.5;
  const auto record = record_of(folder / "Models/chateau.cao");
  auto catalog = std::make_shared<MonoCatalog>();
  catalog->entries.push_back({.model_id = 1, .record = record});
  const Recognizer recognizer(catalog);
  Tracker tracker(record, camera, {}, &recognizer);
  std::vector<double> off_m;
  std::vector<double> off_rad;
  for (int frame = 1; frame <= 40; ++frame) {
    const TrackResult result =
        tracker.next(read_image(folder / "Images" / numbered("Image_%04d.pgm", frame)), {});
    ASSERT_EQ(result.status, frame == 1 ? TrackStatus::kRecognized : TrackStatus::kTracked)
        << "frame " << frame << ": " << result.reason;
    const Eigen::Isometry3d truth = castle_truth(frame);
    off_m.push_back((result.T_camera_object->translation() - truth.translation()).norm());
    off_rad.push_back(
        rotation_angle_rad(result.T_camera_object->linear() * truth.linear().transpose()));
  }
  EXPECT_LT(median(off_m), 0.4e-3);
  EXPECT_LT(median(off_rad), 0.15 * kDegree);
  EXPECT_LT(*std::max_element(off_m.begin(), off_m.end()), 1.0e-3);
  EXPECT_LT(*std::max_element(off_rad.begin(), off_rad.end()), 0.4 * kDegree);
}

Camera cube_camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 547.7367575;
  camera.fy = 542.0744058;
  camera.cx = 338.7036994;
  camera.cy = 234.5083345;
  return camera;
}

// The pose of the first frame that comes with the video.
Eigen::Isometry3d cube_start() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = rotation_from_vector({2.100485509, 1.146812236, -0.4560126437});
  T.translation() << 0.02231950571, 0.1071368004, 0.5071128378;
  return T;
}

RigidPose rigid(const Eigen::Isometry3d& T) { return {T.linear(), T.translation()}; }

TEST(TrackerSequences, TheCubeInTheVideoIsFollowedThroughAllItsFrames) {
  const fs::path folder = kData / "mbt";
  if (!fs::exists(folder / "cube")) GTEST_SKIP() << "visp-images-data is not installed";
  Tracker tracker(record_of(folder / "cube.cao"), cube_camera(), {}, nullptr);
  tracker.start_from(cube_start());
  std::vector<double> shares;
  for (int frame = 0; frame <= 200; ++frame) {
    const TrackResult result =
        tracker.next(read_image(folder / "cube" / numbered("image%04d.pgm", frame)), {});
    ASSERT_EQ(result.status, TrackStatus::kTracked) << "frame " << frame << ": " << result.reason;
    shares.push_back(result.edge_share);
  }
  // There is no truth; a cube beside its place would not lie on three quarters of its edges.
  EXPECT_GT(*std::min_element(shares.begin(), shares.end()), 0.7);
  EXPECT_GT(median(shares), 0.85);
}

// The same track whether its start was given or recognised: here and, as a camera may be switched
// on at any moment, from the middle of the video.
TEST(TrackerSequences, TheCubeInTheVideoIsFoundFromNothing) {
  constexpr int kFramesToFindIt = 5;
  const fs::path folder = kData / "mbt";
  if (!fs::exists(folder / "cube")) GTEST_SKIP() << "visp-images-data is not installed";
  const auto record = record_of(folder / "cube.cao");
  const SearchModel model = prepare_model(record);
  auto catalog = std::make_shared<MonoCatalog>();
  catalog->entries.push_back({.model_id = 1, .record = record});
  const Recognizer recognizer(catalog);
  Tracker given(record, cube_camera(), {}, nullptr);
  given.start_from(cube_start());
  for (const int first : {0, 100}) {
    Tracker tracker(record, cube_camera(), {}, &recognizer);
    Tracker reference = given;
    int found = -1;
    for (int frame = 0; frame <= 200; ++frame) {
      const GreyImage image = read_image(folder / "cube" / numbered("image%04d.pgm", frame));
      const Eigen::Isometry3d T_given = *reference.next(image, {}).T_camera_object;
      if (frame < first) continue;
      const TrackResult result = tracker.next(image, {});
      if (found < 0 && result.status == TrackStatus::kRecognized) found = frame;
      if (found < 0) continue;
      ASSERT_EQ(result.status, frame == found ? TrackStatus::kRecognized : TrackStatus::kTracked)
          << "frame " << frame << ": " << result.reason;
      // A track that was just found is still being drawn in.
      EXPECT_TRUE(same_but_for_symmetry(
          model, rigid(T_given), rigid(*result.T_camera_object), 2.0 * kDegree, 0.004))
          << "frame " << frame;
    }
    ASSERT_GE(found, first);
    EXPECT_LE(found, first + kFramesToFindIt);
  }
}

}  // namespace
}  // namespace landmarkdb
