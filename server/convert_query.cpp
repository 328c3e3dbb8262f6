#include "server/convert_query.hpp"

#include <cmath>
#include <set>
#include <string>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "server/check_field.hpp"
#include "server/convert_explanation.hpp"

namespace landmarkdb {

namespace {

// Directions shorter than this are taken for "not set" by mistake.
constexpr double kMinDirection = 1e-9;
constexpr double kMaxPriorRadius_m = 1e9;

Profile profile_from(v1::Profile profile) {
  switch (profile) {
    case v1::PROFILE_UNSPECIFIED:
    case v1::PROFILE_ROBUST:
      return Profile::kRobust;
    case v1::PROFILE_PAPER:
      return Profile::kPaper;
    default:
      refuse("options.profile", "no profile has the number " + std::to_string(profile));
  }
}

Measure measure_from(v1::Measure measure) {
  switch (measure) {
    case v1::MEASURE_UNSPECIFIED:
    case v1::MEASURE_L2:
      return Measure::kL2;
    case v1::MEASURE_L1:
      return Measure::kL1;
    case v1::MEASURE_CHI2:
      return Measure::kChi2;
    case v1::MEASURE_INTERSECTION:
      return Measure::kIntersection;
    case v1::MEASURE_CORRELATION:
      return Measure::kCorrelation;
    case v1::MEASURE_BHATTACHARYYA:
      return Measure::kBhattacharyya;
    default:
      refuse("options.measure", "no measure has the number " + std::to_string(measure));
  }
}

Search search_from(v1::Search search) {
  switch (search) {
    case v1::SEARCH_UNSPECIFIED:
    case v1::SEARCH_EXACT:
      return Search::kExact;
    case v1::SEARCH_FLANN:
      return Search::kFlann;
    default:
      refuse("options.search", "no search has the number " + std::to_string(search));
  }
}

Solver solver_from(v1::Solver solver) {
  switch (solver) {
    case v1::SOLVER_UNSPECIFIED:
    case v1::SOLVER_SIMILARITY:
      return Solver::kSimilarity;
    case v1::SOLVER_PNP:
      return Solver::kPnp;
    default:
      refuse("options.solver", "no solver has the number " + std::to_string(solver));
  }
}

std::vector<Filter> filters_from(const v1::QueryOptions& options) {
  std::vector<Filter> filters;
  std::set<int> seen;
  for (const int number : options.filters()) {
    if (!seen.insert(number).second) refuse("options.filters", "names one filter twice");
    switch (number) {
      case v1::FILTER_RATIO:
        filters.push_back(Filter::kRatio);
        break;
      case v1::FILTER_SLOPE:
        filters.push_back(Filter::kSlope);
        break;
      case v1::FILTER_CLIQUE:
        filters.push_back(Filter::kClique);
        break;
      default:
        refuse("options.filters", "no filter has the number " + std::to_string(number));
    }
  }
  return filters;
}

void read_prior(const v1::QueryOptions& message, QueryOptions& options) {
  if (message.prior_t_scene_sensor().empty()) {
    if (message.prior_radius_m() != 0.0) {
      refuse("options.prior_radius_m", "is set, but there is no prior_t_scene_sensor");
    }
    return;
  }
  const auto& numbers = message.prior_t_scene_sensor();
  options.prior_T_scene_sensor = pose_from_proto(
      {numbers.data(), static_cast<std::size_t>(numbers.size())}, "options.prior_t_scene_sensor");
  options.prior_radius_m =
      in_range(message.prior_radius_m(), 0.0, kMaxPriorRadius_m, "options.prior_radius_m");
  if (options.prior_radius_m == 0.0) {
    refuse("options.prior_radius_m", "is 0, want metres above 0 with a prior");
  }
}

template <typename Matrix>
void add_row_major(const Matrix& matrix, google::protobuf::RepeatedField<double>& out) {
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) out.Add(matrix(row, column));
  }
}

v1::Hypothesis hypothesis_message(const Hypothesis& hypothesis) {
  v1::Hypothesis message;
  message.set_scene(hypothesis.scene);
  message.set_scene_version(hypothesis.scene_version);
  if (hypothesis.landmark) message.set_landmark(*hypothesis.landmark);
  message.set_confidence(hypothesis.confidence);

  add_row_major(hypothesis.T_scene_sensor, *message.mutable_t_scene_sensor());
  const Eigen::Matrix3d R = nearest_rotation(hypothesis.T_scene_sensor.topLeftCorner<3, 3>());
  const Eigen::Quaterniond q(R);
  *message.mutable_translation_m() = to_proto(hypothesis.T_scene_sensor.topRightCorner<3, 1>());
  for (const double number : {q.x(), q.y(), q.z(), q.w()}) message.add_rotation_xyzw(number);
  *message.mutable_roll_pitch_yaw_rad() = to_proto(roll_pitch_yaw_rad(R));

  v1::PoseChain& chain = *message.mutable_chain();
  add_row_major(hypothesis.chain.T_landmark_sensor, *chain.mutable_t_landmark_sensor());
  add_row_major(hypothesis.chain.T_scene_landmark, *chain.mutable_t_scene_landmark());
  add_row_major(hypothesis.chain.T_icp, *chain.mutable_t_icp());
  chain.set_scale(hypothesis.chain.scale);

  v1::CorrespondenceCounts& counts = *message.mutable_correspondences();
  counts.set_putative(hypothesis.counts.putative);
  counts.set_after_ratio(hypothesis.counts.after_ratio);
  counts.set_after_slope(hypothesis.counts.after_slope);
  counts.set_after_consistency(hypothesis.counts.after_consistency);
  counts.set_inliers(hypothesis.counts.inliers);

  v1::Fit& fit = *message.mutable_fit();
  fit.set_overlap(hypothesis.fit.overlap);
  fit.set_rmse_m(hypothesis.fit.rmse_m);
  fit.set_free_space_violation(hypothesis.fit.free_space_violation);
  fit.set_margin(hypothesis.fit.margin);
  fit.set_observability(hypothesis.fit.observability);
  fit.set_contrast(hypothesis.fit.contrast);
  fit.set_contradicted(hypothesis.fit.contradicted);
  fit.set_refuted(hypothesis.fit.refuted);
  fit.set_agreeing(hypothesis.fit.agreeing);
  fit.set_explained(hypothesis.fit.explained);
  fit.set_coverage(hypothesis.fit.coverage);
  fit.set_quality(hypothesis.fit.quality);
  add_row_major(hypothesis.covariance, *message.mutable_covariance());
  message.set_rival(hypothesis.rival);
  return message;
}

v1::QueryStatus status_number(QueryStatus status) {
  switch (status) {
    case QueryStatus::kLocalized:
      return v1::QUERY_STATUS_LOCALIZED;
    case QueryStatus::kAmbiguous:
      return v1::QUERY_STATUS_AMBIGUOUS;
    case QueryStatus::kNotFound:
      return v1::QUERY_STATUS_NOT_FOUND;
  }
  return v1::QUERY_STATUS_UNSPECIFIED;
}

void set_timings(const StageTimings& timings, v1::StageTimings& message) {
  message.set_load_ms(timings.load.count());
  message.set_preprocess_ms(timings.preprocess.count());
  message.set_keypoints_ms(timings.keypoints.count());
  message.set_describe_ms(timings.describe.count());
  message.set_match_ms(timings.match.count());
  message.set_filter_ms(timings.filter.count());
  message.set_pose_ms(timings.pose.count());
  message.set_icp_ms(timings.icp.count());
  message.set_verify_ms(timings.verify.count());
  message.set_total_ms(timings.total.count());
}

}  // namespace

KeypointMethod from_proto(v1::KeypointMethod method,
                          KeypointMethod unset,
                          const std::string& field) {
  switch (method) {
    case v1::KEYPOINT_METHOD_UNSPECIFIED:
      return unset;
    case v1::KEYPOINT_METHOD_UNIFORM:
      return KeypointMethod::kUniform;
    case v1::KEYPOINT_METHOD_STRUCTURE:
      return KeypointMethod::kStructure;
    case v1::KEYPOINT_METHOD_ISS:
      return KeypointMethod::kIss;
    case v1::KEYPOINT_METHOD_NARF:
      return KeypointMethod::kNarf;
    default:
      refuse(field, "no keypoint method has the number " + std::to_string(method));
  }
}

std::vector<QueryCloud> clouds_from_proto(const v1::QueryRequest& request,
                                          PointAllowance& allowance) {
  constexpr std::size_t kPoseNumbers = 16;
  const auto count = static_cast<std::size_t>(request.clouds_size());
  if (count == 0 || count > kMostQueryClouds) {
    refuse(
        "clouds",
        "there are " + std::to_string(count) + ", want 1 to " + std::to_string(kMostQueryClouds));
  }
  const std::span<const double> poses(request.t_query_clouds().data(),
                                      static_cast<std::size_t>(request.t_query_clouds_size()));
  if (!poses.empty() && poses.size() != kPoseNumbers * count) {
    refuse("t_query_clouds",
           "has " + std::to_string(poses.size()) + " numbers for " + std::to_string(count) +
               " clouds, want 16 each");
  }
  std::vector<QueryCloud> clouds(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string number = "[" + std::to_string(i) + "]";
    if (!poses.empty()) {
      clouds[i].T_query_cloud =
          pose_from_proto(poses.subspan(kPoseNumbers * i, kPoseNumbers), "t_query_clouds" + number);
    }
    clouds[i].cloud = from_proto(request.clouds(static_cast<int>(i)), allowance, "clouds" + number);
  }
  return clouds;
}

v1::KeypointMethod to_proto(KeypointMethod method) {
  switch (method) {
    case KeypointMethod::kUniform:
      return v1::KEYPOINT_METHOD_UNIFORM;
    case KeypointMethod::kStructure:
      return v1::KEYPOINT_METHOD_STRUCTURE;
    case KeypointMethod::kIss:
      return v1::KEYPOINT_METHOD_ISS;
    case KeypointMethod::kNarf:
      return v1::KEYPOINT_METHOD_NARF;
  }
  return v1::KEYPOINT_METHOD_UNSPECIFIED;
}

Eigen::Isometry3d pose_from_proto(std::span<const double> numbers, const std::string& field) {
  if (numbers.size() != 16) {
    refuse(field, "has " + std::to_string(numbers.size()) + " numbers, want 16");
  }
  try {
    return from_row_major(numbers.first<16>());
  } catch (const Error& error) {
    refuse(field, error.what());
  }
}

QueryOptions from_proto(const v1::QueryOptions& message) {
  QueryOptions options;
  options.profile = profile_from(message.profile());
  options.scenes.assign(message.scenes().begin(), message.scenes().end());
  if (message.has_top()) {
    if (message.top() < 1 || message.top() > kMostHypotheses) {
      refuse(
          "options.top",
          "is " + std::to_string(message.top()) + ", want 1 to " + std::to_string(kMostHypotheses));
    }
    options.top = message.top();
  }
  if (message.has_min_confidence()) {
    options.min_confidence = in_range(message.min_confidence(), 0.0, 1.0, "options.min_confidence");
  }
  if (message.has_up()) {
    options.up = from_proto(message.up(), "options.up");
    if (options.up->norm() < kMinDirection) refuse("options.up", "has no length");
  }
  read_prior(message, options);
  if (message.keypoints() != v1::KEYPOINT_METHOD_UNSPECIFIED) {
    options.keypoints =
        from_proto(message.keypoints(), KeypointMethod::kStructure, "options.keypoints");
  }
  options.measure = measure_from(message.measure());
  options.search = search_from(message.search());
  if (message.has_ratio()) options.ratio = in_range(message.ratio(), 0.0, 1.0, "options.ratio");
  options.filters = filters_from(message);
  options.solver = solver_from(message.solver());
  options.estimate_scale = message.estimate_scale();
  if (message.has_seed()) options.seed = message.seed();
  options.want_correspondences = message.want_correspondences();
  options.explain = message.explain();
  options.want_scene_points = message.want_scene_points();
  return options;
}

v1::QueryResult to_proto(const QueryResult& result) {
  v1::QueryResult message;
  message.set_status(status_number(result.status));
  message.set_reason(result.reason);
  for (const Hypothesis& hypothesis : result.hypotheses) {
    *message.add_hypotheses() = hypothesis_message(hypothesis);
  }
  v1::QueryCounts& query = *message.mutable_query();
  query.set_points(result.query.points);
  query.set_points_used(result.query.points_used);
  query.set_invalid(result.query.invalid);
  query.set_keypoints(result.query.keypoints);
  query.set_density_ratio(result.query.density_ratio);
  query.set_seed(result.seed);
  for (const std::string& warning : result.warnings) message.add_warnings(warning);
  set_timings(result.timings, *message.mutable_timing());
  for (const CorrespondenceRecord& record : result.correspondences) {
    v1::Correspondence& pair = *message.add_correspondences();
    pair.set_scene(record.scene);
    *pair.mutable_sensor_m() = to_proto(record.sensor_m.cast<double>());
    *pair.mutable_scene_m() = to_proto(record.scene_m);
    pair.set_distance(record.distance);
    pair.set_dropped_by(record.dropped_by);
  }
  for (const SceneView& view : result.scene_views) *message.add_scene_views() = to_proto(view);
  if (result.explanation) *message.mutable_explanation() = to_proto(*result.explanation);
  return message;
}

}  // namespace landmarkdb
