#include "engine/retrieval/hypothesis.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Eigenvalues>

#include "engine/retrieval/agreement.hpp"

namespace landmarkdb {

namespace {

Eigen::Matrix4d translation(const Eigen::Vector3d& t) {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topRightCorner<3, 1>() = t;
  return T;
}

// Inverse of the information, freedom by freedom: one that the surface does not fix gets a large
// variance instead of an infinite one.
Eigen::Matrix<double, 6, 6> bounded_inverse(const Eigen::Matrix<double, 6, 6>& information,
                                            double largest_variance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(information);
  Eigen::Matrix<double, 6, 1> variance;
  for (int i = 0; i < 6; ++i) {
    const double value = solver.eigenvalues()(i);
    variance(i) = value > 1.0 / largest_variance ? 1.0 / value : largest_variance;
  }
  return solver.eigenvectors() * variance.asDiagonal() * solver.eigenvectors().transpose();
}

// Covariance of the sensor's position and of its rotation, both in the scene's axes. The residuals
// of neighbouring points are not independent: about kCorrelated of them make one observation. Set
// so that squared errors are what the covariance says (landmarkdb-bench-retrieval, column nees: 1.1
// on the mean of 28 frames at 900,000 points).
Eigen::Matrix<double, 6, 6> covariance_of(const Assessed& pose,
                                          const Entry& entry,
                                          const Eigen::Vector3d& sensor) {
  constexpr double kCorrelated = 35.0;
  constexpr double kLargestVariance = 1.0;  // m^2, rad^2
  const IcpResult& icp = pose.icp;
  const double cell_m = entry.grid.cell_m();
  const double floor_m2 = 0.01 * cell_m * cell_m;  // a tenth of a voxel: what thinning alone leaves
  const Eigen::Matrix<double, 6, 6> information =
      icp.information / (kCorrelated * std::max(icp.noise_m2, floor_m2));
  Eigen::Matrix<double, 6, 6> about_centre = bounded_inverse(information, kLargestVariance);
  Eigen::Vector3d centre = icp.centre_target;
  if (entry.is_object()) {  // refined the other way round: the object in the query's frame
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
    turn.topLeftCorner<3, 3>() = pose.T_entry_sensor.linear();
    turn.bottomRightCorner<3, 3>() = pose.T_entry_sensor.linear();
    about_centre = turn * about_centre * turn.transpose();
    centre = pose.T_entry_sensor * centre;
  }
  // A turn w about the centre carries the sensor by w x (p - centre).
  const Eigen::Vector3d arm = pose.T_entry_sensor * sensor - centre;
  Eigen::Matrix<double, 6, 6> J = Eigen::Matrix<double, 6, 6>::Identity();
  J.topRightCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
  return J * about_centre * J.transpose();
}

std::optional<std::string> landmark_of(const Entry& entry,
                                       const EntryMatches& matches,
                                       std::span<const std::uint32_t> inliers) {
  const SceneRecord& record = entry.record();
  std::optional<std::string> best;
  std::size_t most = 0;
  for (const Landmark& landmark : entry.stored.landmarks) {
    const auto inside =
        static_cast<std::size_t>(std::count_if(inliers.begin(), inliers.end(), [&](auto i) {
          const Eigen::Vector3d p =
              record.descriptors.keypoints[matches.putative[i].target].template cast<double>() +
              record.prepared.origin;
          return (p.array() >= landmark.min_m.array()).all() &&
                 (p.array() <= landmark.max_m.array()).all();
        }));
    if (inside > most) {
      most = inside;
      best = landmark.name;
    }
  }
  return best;
}

// For a filter that was not used the count stays what it was before it.
CorrespondenceCounts counts_of(const EntryMatches& matches, std::size_t inliers) {
  CorrespondenceCounts counts = matches.counts;
  if (matches.dropped_by.empty()) {
    counts.after_ratio = counts.putative;
    counts.after_slope = counts.putative;
    counts.after_consistency = static_cast<std::uint32_t>(inliers);
  }
  counts.inliers = static_cast<std::uint32_t>(inliers);
  return counts;
}

}  // namespace

ChainResult chain_of(const Judged& judged, const SearchInput& input, const EntryMatches& matches) {
  const Entry& entry = input.entries[matches.entry];
  return make_chain({.query = matches.view->descriptors,
                     .entry = entry.record().descriptors,
                     .correspondences = matches.putative,
                     .proposer = judged.pose.correspondence,
                     .T_entry_sensor = judged.pose.T_entry_sensor,
                     .inlier_m = kInlierCells * entry.grid.cell_m(),
                     .estimate_scale = input.options.estimate_scale});
}

Hypothesis make_hypothesis(const Judged& judged,
                           const SearchInput& input,
                           const SearchResult& result) {
  const Assessed& pose = judged.pose;
  const EntryMatches& matches = result.matches[pose.matches];
  const Entry& entry = input.entries[pose.entry];
  const ChainResult made = chain_of(judged, input, matches);

  Hypothesis hypothesis;
  hypothesis.scene = entry.record().name;
  hypothesis.scene_version = entry.stored.version;
  hypothesis.landmark = landmark_of(entry, matches, made.inliers);
  hypothesis.confidence = judged.confidence;
  // Out of the float coordinates: the entry's origin on the one side, the query's on the other. The
  // last link moves about the origin, T(o) T_icp T(-o), so that it stays a small motion.
  const Eigen::Vector3d& origin = entry.record().prepared.origin;
  hypothesis.chain = made.chain;
  hypothesis.chain.T_landmark_sensor =
      made.chain.T_landmark_sensor * translation(-input.query.cloud.origin);
  hypothesis.chain.T_scene_landmark = translation(origin) * made.chain.T_scene_landmark;
  hypothesis.chain.T_icp = translation(origin) * made.chain.T_icp * translation(-origin);
  hypothesis.T_scene_sensor = hypothesis.chain.T_icp * hypothesis.chain.T_scene_landmark *
                              hypothesis.chain.T_landmark_sensor;
  hypothesis.counts = counts_of(matches, made.inliers.size());
  hypothesis.fit = {.overlap = pose.evidence.overlap,
                    .rmse_m = pose.evidence.rmse_m,
                    .free_space_violation = pose.evidence.crossed,
                    .explained = pose.evidence.explained,
                    .coverage = pose.evidence.coverage,
                    .quality = pose.score,
                    .margin = judged.margin,
                    .agreeing = pose.evidence.agreeing,
                    .contrast = pose.evidence.contrast,
                    .contradicted = pose.evidence.contradicted,
                    .refuted = pose.evidence.refuted,
                    .observability = pose.evidence.observability,
                    .outgrown = pose.evidence.outgrown,
                    .seen_points = pose.evidence.seen_points,
                    .closeness = pose.evidence.closeness,
                    .structure = pose.evidence.structure,
                    .confirmed = pose.evidence.confirmed,
                    .continued = pose.evidence.continued};
  hypothesis.rival = judged.rival;
  hypothesis.covariance = covariance_of(pose, entry, -input.query.cloud.origin);
  return hypothesis;
}

}  // namespace landmarkdb
