#include "engine/retrieval/object_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace landmarkdb {

namespace {

// Tighter than for places: an object is a few centimetres deep.
constexpr double kSightToleranceRange = 0.008;
constexpr double kSightToleranceCells = 1.5;

struct Patch {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

// The part of an object's surface that the sensor must have seen.
Patch expected(const Meeting& object,
               std::span<const RangeImage> ranges,
               std::span<const Eigen::Vector3f> viewpoints,
               const Eigen::Isometry3d& T_object_sensor) {
  constexpr float kGrazing = 0.2F;  // cosine: flatter surface is rarely measured
  const Eigen::Isometry3f T = T_object_sensor.cast<float>();
  const Eigen::Isometry3f T_sensor_object = T_object_sensor.inverse().cast<float>();
  const float slack_m = 2.0F * object.target.cell_m();
  Patch patch;
  for (std::size_t i = 0; i < object.source.size(); ++i) {
    const bool faces =
        std::any_of(viewpoints.begin(), viewpoints.end(), [&](const Eigen::Vector3f& viewpoint) {
          const Eigen::Vector3f ray = T * viewpoint - object.source[i];
          return object.source_normals[i].dot(ray) >= kGrazing * ray.norm();
        });
    if (!faces) continue;
    const Eigen::Vector3f there = T_sensor_object * object.source[i];
    const bool hidden = std::all_of(ranges.begin(), ranges.end(), [&](const RangeImage& image) {
      return image.hides(there, slack_m + static_cast<float>(kSightToleranceRange) * there.norm());
    });
    if (hidden) continue;
    patch.points.push_back(object.source[i]);
    patch.normals.push_back(object.source_normals[i]);
  }
  return patch;
}

// Few points prove little: shares are drawn towards what a wrong pose reaches, as if so many of its
// points had been seen before.
double object_quality(const Evidence& evidence, double points) {
  constexpr double kPriorPoints = 150.0;
  constexpr double kPriorShare = 0.35;
  const double overlap = 0.5 * (evidence.overlap + evidence.balanced);
  const double drawn = (overlap * points + kPriorShare * kPriorPoints) / (points + kPriorPoints);
  return drawn * evidence.explained * evidence.explained;
}

// 1 for a closed surface, whose normals add up to nothing, 0 for one open to a side.
double closed_share(std::span<const Eigen::Vector3f> normals) {
  constexpr double kOpen = 0.35;  // a box without its underside: 0.2 at most; half a ball: 0.5
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& normal : normals) sum += normal.cast<double>();
  const double mean = sum.norm() / static_cast<double>(std::max<std::size_t>(normals.size(), 1));
  return std::clamp(1.0 - mean / kOpen, 0.0, 1.0);
}

}  // namespace

void look_at_object(const Meeting& meeting,
                    const Entry& entry,
                    const CleanQuery& query,
                    Assessed& assessed) {
  const std::span<const RangeImage> ranges = meeting.ranges.empty() ? query.ranges : meeting.ranges;
  const Patch seen = expected(meeting, ranges, query.cloud.viewpoints, assessed.T_entry_sensor);
  Evidence& evidence = assessed.evidence;
  VerifyOptions verify;
  verify.sight_tolerance_range = kSightToleranceRange;
  verify.sight_tolerance_cells = kSightToleranceCells;
  measure_overlap(
      meeting.target, seen.points, seen.normals, assessed.icp.T_target_source, verify, evidence);
  measure_sight(ranges,
                entry.sight,
                assessed.T_entry_sensor.inverse(),
                entry.record().prepared.resolution_m,
                verify,
                evidence);
  // Clutter may stand before an object: what is hidden says nothing.
  evidence.of_object = true;
  const double judged = evidence.explained + evidence.crossed;
  evidence.explained = judged > 0.0 ? evidence.explained / judged : 0.0;
  evidence.crossed = judged > 0.0 ? evidence.crossed / judged : 0.0;
  // How much of the surface there is to be seen.
  evidence.coverage = static_cast<double>(seen.points.size()) /
                      static_cast<double>(std::max<std::size_t>(meeting.source.size(), 1));
  // Only what can be seen can fix the pose: of that part's pairs, not of all.
  if (evidence.coverage > 0.0) {
    evidence.observability = std::min(1.0, evidence.observability / evidence.coverage);
  }
  assessed.score = object_quality(evidence, static_cast<double>(seen.points.size()));
}

double outgrown_share(const Meeting& meeting,
                      const Entry& entry,
                      const Eigen::Isometry3d& T_entry_sensor) {
  constexpr float kFlush = 0.5F;     // cells from the object's plane
  constexpr float kBeyond = 1.25F;   // cells beside the nearest of its points
  constexpr float kParallel = 0.9F;  // cosine
  constexpr double kRim =
      0.75 * 4.0;  // cells between kBeyond and the grid's reach, sides of a square
  const float cell_m = entry.grid.cell_m();
  const Eigen::Isometry3f T = T_entry_sensor.cast<float>();
  const Eigen::Vector3f centre = T.inverse() * entry.centre.cast<float>();
  const auto reach_m = static_cast<float>(1.5 * entry.extent_m) + entry.grid.reach_m();
  std::size_t on = 0;
  std::size_t beyond = 0;
  for (const Surfel& surfel : meeting.target.surfels()) {
    if ((surfel.point - centre).squaredNorm() > reach_m * reach_m) continue;
    const Eigen::Vector3f p = T * surfel.point;
    const Surfel* near = entry.grid.near(p);
    if (near == nullptr || near->normal.dot(T.linear() * surfel.normal) < kParallel) continue;
    const Eigen::Vector3f offset = p - near->point;
    const float out = near->normal.dot(offset);
    if (std::abs(out) > kFlush * cell_m) continue;
    const bool beside = (offset - out * near->normal).norm() > kBeyond * cell_m;
    ++(beside ? beyond : on);
  }
  if (on == 0) return 0.0;
  const double rim = kRim * std::sqrt(static_cast<double>(on));
  return closed_share(meeting.source_normals) * std::min(1.0, static_cast<double>(beyond) / rim);
}

}  // namespace landmarkdb
