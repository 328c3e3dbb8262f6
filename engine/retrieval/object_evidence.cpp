#include "engine/retrieval/object_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "engine/registration/pose_score.hpp"
#include "engine/retrieval/agreement.hpp"

namespace landmarkdb {

namespace {

// Tighter than for places: an object is a few centimetres deep.
constexpr double kSightToleranceRange = 0.008;
constexpr double kSightToleranceCells = 1.5;
// Cosine: the query's normals are those of wider neighbourhoods where an object has detail.
constexpr double kLeastAgreement = 0.5;
constexpr double kNoises = 2.0;  // standard deviations of the noise that still are the surface

struct Patch {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

// An object's own surface as it is seen from one viewpoint: what of it hides the rest.
class OwnView {
 public:
  OwnView(std::span<const Eigen::Vector3f> points, const Eigen::Vector3f& viewpoint, float pixel_m)
      : viewpoint_(viewpoint), pixel_m_(pixel_m) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& point : points) middle += point;
    middle = middle / static_cast<float>(std::max<std::size_t>(points.size(), 1)) - viewpoint;
    distance_m_ = middle.norm();
    ahead_ = middle.stableNormalized();
    if (!(distance_m_ > 0.0F)) return;
    right_ = ahead_.unitOrthogonal();
    up_ = ahead_.cross(right_);
    lay_out(points);
  }

  // Whether nothing of the object stands before its point.
  bool shows(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
    if (nearest_.empty()) return true;
    const Seen seen = look(point);
    const int column = column_of(seen);
    const int row = row_of(seen);
    // Over one pixel a slanted surface itself comes nearer by so much.
    const float cosine = std::max(0.2F, -normal.dot((point - viewpoint_).stableNormalized()));
    const float slack_m =
        pixel_m_ * (1.0F + std::sqrt(1.0F - std::min(1.0F, cosine * cosine)) / cosine);
    for (int y = std::max(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
      for (int x = std::max(0, column - 1); x <= std::min(columns_ - 1, column + 1); ++x) {
        if (nearest_[static_cast<std::size_t>(y * columns_ + x)] < seen.depth_m - slack_m)
          return false;
      }
    }
    return true;
  }

 private:
  struct Seen {
    Eigen::Vector2f at;  // pixels
    float depth_m;
  };
  Seen look(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f ray = point - viewpoint_;
    const float depth_m = ahead_.dot(ray);
    const float pixels = distance_m_ / (std::max(depth_m, 0.1F * distance_m_) * pixel_m_);
    return {Eigen::Vector2f(right_.dot(ray), up_.dot(ray)) * pixels, depth_m};
  }
  int column_of(const Seen& seen) const {
    return std::clamp(static_cast<int>(seen.at.x() - low_.x()), 0, columns_ - 1);
  }
  int row_of(const Seen& seen) const {
    return std::clamp(static_cast<int>(seen.at.y() - low_.y()), 0, rows_ - 1);
  }
  void lay_out(std::span<const Eigen::Vector3f> points) {
    constexpr float kMostPixels = 1024.0F;  // along a side
    low_ = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector2f high = -low_;
    for (const Eigen::Vector3f& point : points) {
      const Seen seen = look(point);
      low_ = low_.cwiseMin(seen.at);
      high = high.cwiseMax(seen.at);
    }
    const Eigen::Vector2f size = high - low_;
    if (!(size.maxCoeff() < kMostPixels)) return;  // the viewpoint is within
    columns_ = static_cast<int>(size.x()) + 1;
    rows_ = static_cast<int>(size.y()) + 1;
    nearest_.assign(static_cast<std::size_t>(columns_ * rows_), std::numeric_limits<float>::max());
    for (const Eigen::Vector3f& point : points) {
      const Seen seen = look(point);
      float& nearest =
          nearest_[static_cast<std::size_t>(row_of(seen) * columns_ + column_of(seen))];
      nearest = std::min(nearest, seen.depth_m);
    }
  }

  Eigen::Vector3f viewpoint_;
  float pixel_m_;
  float distance_m_ = 0.0F;
  Eigen::Vector3f ahead_ = Eigen::Vector3f::UnitZ(), right_ = ahead_, up_ = ahead_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();
  int columns_ = 0, rows_ = 0;
  std::vector<float> nearest_;
};

// Of `points` (object frame) those that the sensor must have seen: they face a viewpoint, and
// neither the rest of the object nor what was measured stands before them.
std::vector<std::uint32_t> expected_points(std::span<const Eigen::Vector3f> points,
                                           std::span<const Eigen::Vector3f> normals,
                                           const Meeting& object,
                                           const CleanQuery& query,
                                           const Eigen::Isometry3d& T_object_sensor) {
  constexpr float kGrazing = 0.2F;  // cosine: flatter surface is rarely measured
  const std::span<const RangeImage> ranges = object.ranges.empty() ? query.ranges : object.ranges;
  const Eigen::Isometry3f T = T_object_sensor.cast<float>();
  const Eigen::Isometry3f T_sensor_object = T_object_sensor.inverse().cast<float>();
  const float cell_m = object.target.cell_m();
  std::vector<OwnView> views;
  std::vector<Eigen::Vector3f> viewpoints;
  for (const Eigen::Vector3f& viewpoint : query.cloud.viewpoints) {
    viewpoints.push_back(T * viewpoint);
    views.emplace_back(object.source, viewpoints.back(), cell_m);
  }
  std::vector<std::uint32_t> seen;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    bool shows = false;
    for (std::size_t k = 0; k < views.size() && !shows; ++k) {
      const Eigen::Vector3f ray = viewpoints[k] - points[i];
      shows = normals[i].dot(ray) >= kGrazing * ray.norm() && views[k].shows(points[i], normals[i]);
    }
    if (!shows) continue;
    const Eigen::Vector3f there = T_sensor_object * points[i];
    const float slack_m = cell_m + static_cast<float>(kSightToleranceRange) * there.norm();
    const bool hidden = std::all_of(ranges.begin(), ranges.end(), [&](const RangeImage& image) {
      return image.hides(there, slack_m);
    });
    if (!hidden) seen.push_back(i);
  }
  return seen;
}

// The same of about `most` points of the object's surface.
Patch expected(const Meeting& object,
               const CleanQuery& query,
               const Eigen::Isometry3d& T_object_sensor,
               std::size_t most) {
  Patch all;
  for (const std::uint32_t i : spread(object.source.size(), most)) {
    all.points.push_back(object.source[i]);
    all.normals.push_back(object.source_normals[i]);
  }
  Patch patch;
  for (const std::uint32_t i :
       expected_points(all.points, all.normals, object, query, T_object_sensor)) {
    patch.points.push_back(all.points[i]);
    patch.normals.push_back(all.normals[i]);
  }
  return patch;
}

// How far the query's points scatter about the surface where the object stands, in cells.
double noise_cells(const Meeting& meeting,
                   const CleanQuery& query,
                   const Entry& entry,
                   const Eigen::Isometry3d& T_entry_sensor) {
  constexpr double kMost = 1.0;  // beyond, the surface is not to be told from what is beside it
  if (meeting.noise == nullptr) return 0.0;
  const Eigen::Vector3f centre = (T_entry_sensor.inverse() * entry.centre).cast<float>();
  float range_m = std::numeric_limits<float>::max();
  for (const Eigen::Vector3f& viewpoint : query.cloud.viewpoints) {
    range_m = std::min(range_m, (centre - viewpoint).norm());
  }
  return std::min(kMost, static_cast<double>(meeting.noise->at(range_m) / meeting.target.cell_m()));
}

// How closely the patch lies on the query's surface, and how evenly the normals of what lies on it
// are spread.
void measure_closeness(const SurfaceGrid& target,
                       const Patch& patch,
                       const Eigen::Isometry3d& T_target_source,
                       double noise_cells,
                       Evidence& evidence) {
  constexpr double kSigmaCells = 0.3;  // what thinning leaves
  const Eigen::Matrix3f R = T_target_source.linear().cast<float>();
  const Eigen::Vector3f t = T_target_source.translation().cast<float>();
  const auto sigma =
      static_cast<float>(std::hypot(kSigmaCells, kNoises * noise_cells)) * target.cell_m();
  const float factor = -0.5F / (sigma * sigma);
  double sum = 0.0;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < patch.points.size(); ++i) {
    const Eigen::Vector3f normal = R * patch.normals[i];
    const auto fit =
        static_cast<double>(surface_fit(target, R * patch.points[i] + t, normal, factor));
    sum += fit;
    scatter += fit * (normal * normal.transpose()).cast<double>();
  }
  const auto points = static_cast<double>(patch.points.size());
  evidence.closeness = points > 0.0 ? sum / points : 0.0;
  if (!(sum > 0.0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter, Eigen::EigenvaluesOnly);
  evidence.structure = std::clamp(3.0 * solver.eigenvalues()(0) / scatter.trace(), 0.0, 1.0);
}

// Few points prove little: shares are drawn towards what a wrong pose reaches, as if so many of its
// points had been seen before.
double object_quality(const Evidence& evidence) {
  constexpr double kPriorPoints = 50.0;
  constexpr double kPriorShare = 0.35;
  const double overlap = 0.5 * (evidence.overlap + evidence.closeness);
  const double points = evidence.seen_points;
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
                    std::size_t most_points,
                    Assessed& assessed) {
  const std::span<const RangeImage> ranges = meeting.ranges.empty() ? query.ranges : meeting.ranges;
  const std::size_t taken = std::min(most_points, meeting.source.size());
  const Patch seen = expected(meeting, query, assessed.T_entry_sensor, taken);
  Evidence& evidence = assessed.evidence;
  VerifyOptions verify;
  const double noise = noise_cells(meeting, query, entry, assessed.T_entry_sensor);
  verify.surface_tolerance_cells = std::hypot(verify.surface_tolerance_cells, kNoises * noise);
  verify.min_normal_agreement = kLeastAgreement;
  verify.sight_tolerance_range = kSightToleranceRange;
  verify.sight_tolerance_cells = kSightToleranceCells;
  verify.hidden_contradicts = false;
  measure_overlap(meeting.target,
                  seen.points,
                  seen.normals,
                  assessed.icp.T_target_source,
                  nullptr,
                  verify,
                  evidence);
  measure_closeness(meeting.target, seen, assessed.icp.T_target_source, noise, evidence);
  measure_sight(ranges,
                entry.sight.get(1),
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
                      static_cast<double>(std::max<std::size_t>(taken, 1));
  evidence.seen_points = evidence.coverage * static_cast<double>(meeting.source.size());
  // Only what can be seen can fix the pose: of that part's pairs, not of all.
  if (evidence.coverage > 0.0) {
    evidence.observability = std::min(1.0, evidence.observability / evidence.coverage);
  }
  assessed.score = object_quality(evidence);
}

void refine_seen(const Meeting& meeting, const CleanQuery& query, Assessed& assessed) {
  constexpr std::size_t kFewest = 50;  // fewer show a face at most
  IcpOptions options;
  options.start_scale_cells = 1.0;
  const Patch seen = expected(meeting, query, assessed.T_entry_sensor, meeting.source.size());
  if (seen.points.size() < kFewest) return;
  assessed.icp =
      refine_icp(meeting.target, seen.points, seen.normals, assessed.icp.T_target_source, options);
  assessed.T_entry_sensor = assessed.icp.T_target_source.inverse();
}

double continued_share(const Meeting& meeting,
                       const Entry& entry,
                       const Eigen::Isometry3d& T_entry_sensor) {
  const double cell_m = entry.record().prepared.resolution_m;
  const SightTolerance tolerance{static_cast<float>(kSightToleranceCells * cell_m),
                                 static_cast<float>(kSightToleranceRange)};
  OutlineCounts counts;
  for (const RangeImage& image : meeting.ranges) {
    counts += image.outline(
        entry.sight.get(1), T_entry_sensor.inverse(), static_cast<float>(cell_m), tolerance);
  }
  if (counts.measured == 0) return 0.0;
  return closed_share(meeting.source_normals) * static_cast<double>(counts.continued) /
         static_cast<double>(counts.measured);
}

double confirmed_share(const Meeting& meeting,
                       const Entry& entry,
                       const CleanQuery& query,
                       const EntryMatches& matches,
                       const Eigen::Isometry3d& T_entry_sensor) {
  const DescriptorSet& mine = entry.record().descriptors;
  const DescriptorSet& theirs = matches.view->descriptors;
  const Eigen::Isometry3f T = T_entry_sensor.inverse().cast<float>();
  const auto near_m = static_cast<float>(kInlierCells) * meeting.target.cell_m();
  std::vector<char> agrees(mine.size(), 0);
  for (const Correspondence& pair : matches.putative) {
    const Eigen::Vector3f there = T * mine.keypoints[pair.target];
    const float squared = (there - theirs.keypoints[pair.query]).squaredNorm();
    if (squared <= near_m * near_m) agrees[pair.target] = 1;
  }
  const std::vector<std::uint32_t> seen =
      expected_points(mine.keypoints, mine.normals, meeting, query, T_entry_sensor);
  double agreeing = 0.0;
  for (const std::uint32_t i : seen) agreeing += static_cast<double>(agrees[i]);
  return seen.empty() ? 0.0 : agreeing / static_cast<double>(seen.size());
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
