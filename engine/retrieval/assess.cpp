#include "engine/retrieval/assess.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/registration/gyration.hpp"
#include "engine/retrieval/object_evidence.hpp"
#include "engine/retrieval/rank_poses.hpp"

namespace landmarkdb {

namespace {

constexpr double kWideStart = 2.5;  // cells of the target: IcpOptions::start_scale_cells
constexpr std::size_t kCoarsePoints = 400;
constexpr std::size_t kFinePoints = 1000;
constexpr std::size_t kCoarseLook = 1000;  // a third of which can be seen

Eigen::Isometry3d turned(const Eigen::Isometry3d& T, bool inverse) {
  return inverse ? T.inverse() : T;
}

// Few points prove little: a coarse entry's surface is near anything. The shares are drawn towards
// what a wrong pose reaches, as if kPriorPoints of its points had been seen before.
double drawn_in(double share, double points) {
  constexpr double kPriorPoints = 300.0;
  constexpr double kPriorShare = 0.35;
  return (share * points + kPriorShare * kPriorPoints) / (points + kPriorPoints);
}

// How well a pose explains the query. Overlap counts the surface that is there, against what can be
// there at all (`possible`); sight counts the directions in which entry and sensor agree. Each
// alone is fooled: overlap by bare walls, sight by an entry seen from outside.
double quality(const Evidence& evidence, double possible, double points) {
  const double overlap = std::min(1.0, 0.5 * (evidence.overlap + evidence.balanced) / possible);
  const double in_view =
      0.5 + 0.5 * evidence.coverage;  // what agrees in a corner of the view is half a proof
  // What stands where the scanner looked through counts for more than what is missing: 95 % of
  // right poses have less than 0.3 % of it, half of the wrong ones more than 3 %.
  const double not_refuted = std::pow(1.0 - evidence.refuted, 4);
  return drawn_in(overlap, points) * evidence.explained * evidence.explained * in_view *
         not_refuted;
}

// A place can hold what it was scanned for, and a query mostly outside of that is not half proved.
double possible_in_place(const Evidence& evidence) {
  constexpr double kLeast = 0.5;
  return std::max(evidence.coverage, kLeast);
}

// Of 2,900 frames, more than half of them of places that were not there, what contradicts by half
// of the tolerance of sight tells wrong poses best (docs/decisions/0028); right ones of real
// sensors have hardly any of it.
constexpr double kContradictionShare = 0.5;

VerifyOptions verify_options(const Meeting& meeting) {
  VerifyOptions options;
  options.contradiction_share = kContradictionShare;
  if (meeting.tolerance_m > 0.0) {
    options.surface_tolerance_cells = meeting.tolerance_m / meeting.target.cell_m();
  }
  return options;
}

// The last millimetres, by what is to be relied on.
void refine_precisely(const Meeting& meeting, Assessed& assessed) {
  IcpOptions options;
  options.start_scale_cells = kWideStart;
  options.max_iterations = 40;
  assessed.icp = refine_icp(
      meeting.target, meeting.precise, meeting.precise_normals, assessed.T_entry_sensor, options);
  assessed.T_entry_sensor = assessed.icp.T_target_source;
}

// What all points of the query are paired with where they lie.
IcpResult paired_at(const Meeting& meeting, const Eigen::Isometry3d& T_entry_sensor) {
  IcpOptions options;
  options.max_iterations = 0;
  return refine_icp(
      meeting.target, meeting.source, meeting.source_normals, T_entry_sensor, options);
}

// Points of the query that a pose of a place is judged by.
struct Judges {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

Judges some_judges(const Meeting& meeting, std::size_t count) {
  Judges judges;
  for (const std::uint32_t i : spread(meeting.source.size(), count)) {
    judges.points.push_back(meeting.source[i]);
    judges.normals.push_back(meeting.source_normals[i]);
  }
  return judges;
}

// What these points and the entry's surface as seen from the pose, in patches of this width, say.
void judge_in_place(const Meeting& meeting,
                    const Entry& entry,
                    const CleanQuery& query,
                    std::span<const Eigen::Vector3f> points,
                    std::span<const Eigen::Vector3f> normals,
                    const SightSurface& surface,
                    double patch_m,
                    Assessed& assessed) {
  Evidence& evidence = assessed.evidence;
  const VerifyOptions verify = verify_options(meeting);
  measure_overlap(
      meeting.target, points, normals, assessed.T_entry_sensor, &entry.scanned, verify, evidence);
  measure_sight(
      query.ranges, surface, assessed.T_entry_sensor.inverse(), patch_m, verify, evidence);
  assessed.score =
      quality(evidence, possible_in_place(evidence), static_cast<double>(meeting.source.size()));
}

// The same as far as the surface of the entry's wide grid shows it.
void judge_by_wide_surface(const Meeting& meeting,
                           const Entry& entry,
                           const CleanQuery& query,
                           const Judges& judges,
                           Assessed& assessed) {
  judge_in_place(meeting,
                 entry,
                 query,
                 judges.points,
                 judges.normals,
                 entry.wide_sight,
                 entry.wide.cell_m(),
                 assessed);
}

}  // namespace

bool same_spot(const Assessed& a,
               const Assessed& b,
               const Entry& entry,
               const Eigen::Vector3d& query_centre,
               double translation_m,
               double rotation_rad) {
  if (a.entry != b.entry) return false;
  return entry.is_object()
             ? same_pose(a.T_entry_sensor.inverse(),
                         b.T_entry_sensor.inverse(),
                         entry.centre,
                         translation_m,
                         rotation_rad)
             : same_pose(
                   a.T_entry_sensor, b.T_entry_sensor, query_centre, translation_m, rotation_rad);
}

Assessed assess_coarse(const Meeting& meeting,
                       const Entry& entry,
                       const CleanQuery& query,
                       const Eigen::Isometry3d& T_entry_sensor) {
  const Judges some = some_judges(meeting, kCoarsePoints);
  IcpOptions options;
  options.start_scale_cells = kWideStart;
  options.max_iterations = 20;
  Assessed assessed;
  assessed.T_entry_proposed = T_entry_sensor;
  assessed.icp = refine_icp(meeting.target,
                            some.points,
                            some.normals,
                            turned(T_entry_sensor, meeting.entry_is_source),
                            options);
  assessed.T_entry_sensor = turned(assessed.icp.T_target_source, meeting.entry_is_source);
  if (meeting.entry_is_source) {
    look_at_object(meeting, entry, query, kCoarseLook, assessed);
    return assessed;
  }
  judge_by_wide_surface(meeting, entry, query, some, assessed);
  return assessed;
}

void assess_fine(const Meeting& meeting,
                 const Entry& entry,
                 const CleanQuery& query,
                 Assessed& assessed) {
  IcpOptions options;
  options.max_iterations = 40;
  assessed.icp = refine_icp(meeting.target,
                            meeting.source,
                            meeting.source_normals,
                            turned(assessed.T_entry_sensor, meeting.entry_is_source),
                            options);
  assessed.T_entry_sensor = turned(assessed.icp.T_target_source, meeting.entry_is_source);
  Evidence& evidence = assessed.evidence;
  evidence = {};
  if (meeting.entry_is_source) {
    refine_seen(meeting, query, assessed);
    evidence.observability = observability(
        assessed.icp, measure_gyration(meeting.source).radius_m, meeting.source.size());
    look_at_object(meeting, entry, query, meeting.source.size(), assessed);
    evidence.outgrown = outgrown_share(meeting, entry, assessed.T_entry_sensor);
    evidence.continued = continued_share(meeting, entry, assessed.T_entry_sensor);
    return;
  }
  if (!meeting.precise.empty()) refine_precisely(meeting, assessed);
  evidence.observability = observability(paired_at(meeting, assessed.T_entry_sensor),
                                         measure_gyration(meeting.source).radius_m,
                                         meeting.source.size());
  judge_by_wide_surface(meeting, entry, query, some_judges(meeting, kFinePoints), assessed);
}

void assess_precisely(const Meeting& meeting,
                      const Entry& entry,
                      const CleanQuery& query,
                      Assessed& assessed) {
  judge_in_place(meeting,
                 entry,
                 query,
                 meeting.source,
                 meeting.source_normals,
                 entry.sight.get(1),
                 entry.record().prepared.resolution_m,
                 assessed);
}

}  // namespace landmarkdb
