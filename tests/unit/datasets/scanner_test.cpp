#include "datasets/scanner.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "datasets/shapes/shapes.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::datasets {
namespace {

// An empty room of 8 x 6 x 3 m with a station in its middle: every true range is known.
Place bare_room() {
  Place place;
  place.name = "room";
  const Eigen::Isometry3d T = at(0, 0);
  TriangleMesh& mesh = place.mesh;
  add_box(mesh, T, {8, 6, 3});
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);  // seen from inside
  place.caster = std::make_shared<RayCaster>(mesh);
  place.stations = {at(0.0, 0.0, 1.5)};
  return place;
}

double true_range(const Eigen::Vector3d& direction) {
  return 1.0 / std::max({std::abs(direction.x()) / 4.0,
                         std::abs(direction.y()) / 3.0,
                         std::abs(direction.z()) / 1.5});
}

TEST(ScanPlace, ReturnsExactlyAsManyPointsAsAsked) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.5});
  for (const std::size_t wanted : {1'000U, 12'345U, 40'961U}) {
    std::size_t points = 0;
    for (const StationScan& scan : scan_place(place, {.points = wanted}, {})) {
      points += scan.cloud.size();
      EXPECT_GT(scan.cloud.size(), wanted / 20);
    }
    EXPECT_EQ(points, wanted);
  }
}

TEST(ScanPlace, IsTheSameForAnyNumberOfThreads) {
  const Place place = make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.5});
  RunContext one, three;
  three.threads = 3;
  const auto a = scan_place(place, {.points = 20'000}, one);
  const auto b = scan_place(place, {.points = 20'000}, three);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].cloud.points, b[i].cloud.points);
}

TEST(ScanPlace, SpreadsRangesAsItsNoiseSays) {
  constexpr double kNoise_m = 0.008;
  const auto scans =
      scan_place(bare_room(), {.points = 50'000, .noise_m = kNoise_m, .mixed_pixels = 0.0}, {});
  double sum = 0.0;
  double sum2 = 0.0;
  for (const Eigen::Vector3f& p : scans[0].cloud.points) {
    const Eigen::Vector3d q = p.cast<double>();
    const double error = q.norm() - true_range(q.normalized());
    sum += error;
    sum2 += error * error;
  }
  const auto n = static_cast<double>(scans[0].cloud.size());
  EXPECT_NEAR(sum / n, 0.0, 0.0002);
  EXPECT_NEAR(std::sqrt(sum2 / n), kNoise_m, 0.0002);
}

TEST(ScanPlace, PutsMixedPixelsBetweenSurfacesOnly) {
  Place place = bare_room();
  add_box(place.mesh, at(1.5, 0.0), {0.3, 0.3, 3.0});
  place.caster = std::make_shared<RayCaster>(place.mesh);
  const auto count_between = [&](double share) {
    int between = 0;
    const auto scans =
        scan_place(place, {.points = 30'000, .noise_m = 0.0, .mixed_pixels = share}, {});
    for (const Eigen::Vector3f& p : scans[0].cloud.points) {
      const double to_wall = true_range(p.cast<double>().normalized()) - p.norm();
      const bool on_pillar = p.x() < 1.68F && std::abs(p.y()) < 0.18F;
      if (to_wall > 0.02 && !on_pillar) ++between;
    }
    return between;
  };
  EXPECT_EQ(count_between(0.0), 0);
  EXPECT_GT(count_between(0.5), 20);
}

TEST(MergeStations, KeepsWhoSawWhatInTheSceneFrame) {
  const Place place =
      make_place({.type = PlaceType::kOffice, .seed = 1, .size = 0.5, .stations = 3});
  const auto scans = scan_place(place, {.points = 3'000}, {});
  const PointCloud all = merge_stations(scans);
  ASSERT_EQ(all.size(), 3'000U);
  ASSERT_EQ(all.viewpoints.size(), 3U);
  EXPECT_EQ(all.viewpoint_index.back(), 2);
  const Eigen::Vector3d last =
      scans[2].T_scene_station * scans[2].cloud.points.back().cast<double>();
  EXPECT_LT((all.points.back().cast<double>() - last).norm(), 1e-4);
}

TEST(ScanPlace, RefusesWhatCannotBe) {
  Place place = bare_room();
  EXPECT_THROW(scan_place(place, {.points = 0, .step_rad = 0.0}, {}), Error);
  EXPECT_THROW(scan_place(place, {.points = 1'000'000'000'000}, {}), Error);
  EXPECT_THROW(scan_place(place, {.noise_m = -1.0}, {}), Error);
  place.stations.clear();
  EXPECT_THROW(scan_place(place, {}, {}), Error);
}

TEST(ScanPlace, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_THROW(scan_place(bare_room(), {}, context), Error);
}

}  // namespace
}  // namespace landmarkdb::datasets
