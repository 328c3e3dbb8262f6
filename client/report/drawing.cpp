#include "client/report/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "engine/cloud/sanitise.hpp"
#include "engine/cloud/voxel_grid.hpp"

namespace landmarkdb::client {
namespace {

// A horizontal direction: the wish without its vertical part, or where that leaves nothing, any.
Eigen::Vector3d horizontal(const Eigen::Vector3d& wish, const Eigen::Vector3d& up) {
  constexpr double kLeast = 0.2;  // sine: a wish within 12 deg of the vertical says nothing
  Eigen::Vector3d flat = wish - wish.dot(up) * up;
  if (flat.norm() > kLeast * wish.norm()) return flat.normalized();
  flat = std::abs(up.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  return (flat - flat.dot(up) * up).normalized();
}

std::vector<Eigen::Vector3f> thinned(const PointCloud& cloud) {
  constexpr double kStep = 1.25;
  if (cloud.size() <= kMostDrawnQueryPoints) return cloud.points;
  PointCloud bare;
  bare.points = cloud.points;
  Eigen::Vector3f low = bare.points[0];
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& point : bare.points) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  // As if the points covered one side of their box; never less than that of a tiny cloud.
  constexpr double kTiny_m = 1e-6;
  double voxel_m = std::max(
      kTiny_m,
      (high - low).cast<double>().norm() / std::sqrt(static_cast<double>(kMostDrawnQueryPoints)));
  PointCloud thin_cloud = thin(bare, voxel_m);
  for (; thin_cloud.size() > kMostDrawnQueryPoints; thin_cloud = thin(bare, voxel_m)) {
    voxel_m *= kStep;
  }
  return std::move(thin_cloud.points);
}

// What a camera sees, as the four edges and the end of its view; nothing where the points are not
// all before it.
std::vector<std::vector<Eigen::Vector3d>> camera_lines(std::span<const Eigen::Vector3f> points,
                                                       const Eigen::Vector3f& viewpoint) {
  constexpr float kGrazing = 0.1F;  // a camera of 168 deg
  Eigen::Vector2f low = Eigen::Vector2f::Constant(1e9F);
  Eigen::Vector2f high = -low;
  std::vector<float> depths;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f ray = point - viewpoint;
    if (ray.z() <= kGrazing * ray.norm()) return {};
    const Eigen::Vector2f tangents = ray.head<2>() / ray.z();
    low = low.cwiseMin(tangents);
    high = high.cwiseMax(tangents);
    depths.push_back(ray.z());
  }
  if (depths.empty()) return {};
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  const double depth = 0.5 * static_cast<double>(depths[depths.size() / 2]);
  const Eigen::Vector3d from = viewpoint.cast<double>();
  const auto corner = [&](float x, float y) -> Eigen::Vector3d {
    return from + depth * Eigen::Vector3d(static_cast<double>(x), static_cast<double>(y), 1.0);
  };
  const std::array<Eigen::Vector3d, 4> corners = {corner(low.x(), low.y()),
                                                  corner(high.x(), low.y()),
                                                  corner(high.x(), high.y()),
                                                  corner(low.x(), high.y())};
  std::vector<std::vector<Eigen::Vector3d>> lines;
  for (const Eigen::Vector3d& c : corners) lines.push_back({from, c});
  lines.push_back({corners[0], corners[1], corners[2], corners[3], corners[0]});
  return lines;
}

// A sensor that sees all round: a ring about it.
std::vector<std::vector<Eigen::Vector3d>> ring_lines(const Eigen::Vector3f& viewpoint) {
  constexpr int kSides = 24;
  constexpr double kRadius_m = 0.3;
  std::vector<Eigen::Vector3d> ring;
  for (int i = 0; i <= kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    ring.push_back(viewpoint.cast<double>() +
                   kRadius_m * Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0));
  }
  return {ring};
}

// Above the sensor by a bit, where that hides something and leaves enough.
std::optional<double> ceiling_cut(const SceneView& place,
                                  const Eigen::Vector3d& up,
                                  const Eigen::Vector3d& sensor) {
  constexpr double kAbove_m = 0.3;
  constexpr double kFewestLeft = 0.3;
  constexpr double kMostLeft = 0.98;
  const double cut_m = sensor.dot(up) + kAbove_m;
  const auto below =
      std::count_if(place.points.begin(), place.points.end(), [&](const Eigen::Vector3f& point) {
        return (place.origin + point.cast<double>()).dot(up) <= cut_m;
      });
  const double left = static_cast<double>(below) /
                      static_cast<double>(std::max<std::size_t>(place.points.size(), 1));
  if (left < kFewestLeft || left > kMostLeft) return std::nullopt;
  return cut_m;
}

std::vector<PairLine> evenly(const std::vector<const CorrespondenceRecord*>& pairs) {
  std::vector<PairLine> lines;
  const std::size_t count = std::min(pairs.size(), kMostDrawnPairs);
  for (std::size_t i = 0; i < count; ++i) {
    const CorrespondenceRecord& pair = *pairs[i * pairs.size() / count];
    const Eigen::Vector3d sensor = pair.sensor_m.cast<double>();
    lines.push_back(
        {sensor.x(), sensor.y(), sensor.z(), pair.scene_m.x(), pair.scene_m.y(), pair.scene_m.z()});
  }
  return lines;
}

void draw_pairs(const QueryResult& result, DrawnCandidate& best) {
  std::vector<const CorrespondenceRecord*> inliers;
  std::vector<const CorrespondenceRecord*> rejected;
  for (const CorrespondenceRecord& pair : result.correspondences) {
    (pair.dropped_by.empty() ? inliers : rejected).push_back(&pair);
  }
  best.inliers = evenly(inliers);
  best.rejected = evenly(rejected);
}

DrawnCandidate draw(const Hypothesis& hypothesis,
                    const SceneView& place,
                    const Eigen::Vector3d& viewpoint) {
  DrawnCandidate candidate;
  candidate.scene = hypothesis.scene;
  candidate.T_scene_sensor = hypothesis.T_scene_sensor;
  candidate.chain = hypothesis.chain;
  candidate.place = &place;
  if (place.up) candidate.up = place.up->normalized();
  candidate.above_right = horizontal(Eigen::Vector3d::UnitX(), candidate.up);
  candidate.side_right = horizontal(hypothesis.T_scene_sensor.col(2).head<3>(), candidate.up);
  const Eigen::Vector3d sensor = (hypothesis.T_scene_sensor * viewpoint.homogeneous()).head<3>();
  candidate.cut_m = ceiling_cut(place, candidate.up, sensor);
  return candidate;
}

}  // namespace

Drawing make_drawing(PointCloud cloud,
                     const std::optional<Eigen::Vector3d>& up_sensor,
                     const QueryResult& result) {
  sanitise(cloud);
  Drawing drawing;
  drawing.origin = cloud.origin;
  const Eigen::Vector3f viewpoint =
      cloud.viewpoints.empty() ? Eigen::Vector3f(-cloud.origin.cast<float>()) : cloud.viewpoints[0];
  drawing.viewpoint = cloud.origin + viewpoint.cast<double>();
  if (!cloud.empty()) drawing.query = thinned(cloud);
  drawing.frustum = camera_lines(cloud.points, viewpoint);
  // A camera looks along z with y downwards; any other cloud is taken to stand on its z axis.
  if (!drawing.frustum.empty()) drawing.up = -Eigen::Vector3d::UnitY();
  if (up_sensor) drawing.up = up_sensor->normalized();
  drawing.above_right = horizontal(Eigen::Vector3d::UnitX(), drawing.up);
  drawing.side_right = horizontal(Eigen::Vector3d::UnitZ(), drawing.up);
  if (drawing.frustum.empty()) drawing.frustum = ring_lines(viewpoint);
  for (std::vector<Eigen::Vector3d>& line : drawing.frustum) {
    for (Eigen::Vector3d& point : line) point += cloud.origin;
  }
  const std::size_t views = std::min(result.hypotheses.size(), result.scene_views.size());
  for (std::size_t i = 0; i < views; ++i) {
    drawing.candidates.push_back(
        draw(result.hypotheses[i], result.scene_views[i], drawing.viewpoint));
  }
  if (!drawing.candidates.empty()) draw_pairs(result, drawing.candidates[0]);
  return drawing;
}

}  // namespace landmarkdb::client
