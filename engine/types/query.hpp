#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "engine/base/stage_timings.hpp"
#include "engine/types/explanation.hpp"
#include "engine/types/features.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_view.hpp"

namespace landmarkdb {

enum class Profile { kRobust, kPaper };
enum class Measure { kL2, kL1, kChi2, kIntersection, kCorrelation, kBhattacharyya };
enum class Filter { kRatio, kSlope, kClique };
enum class Search { kExact, kFlann };
enum class Solver { kSimilarity, kPnp };

// The most a question may ask for with `top`: nobody reads more, and each is half a kilobyte.
inline constexpr std::uint32_t kMostHypotheses = 100;

// The most clouds one question may be about.
inline constexpr std::size_t kMostQueryClouds = 64;

// One of the clouds of a question, with its pose in the frame they share: the frame the answer's
// T_scene_sensor is of. A lone cloud's own frame is that frame. Seen from its own zero unless the
// cloud has a viewpoint.
struct QueryCloud {
  PointCloud cloud;
  Eigen::Isometry3d T_query_cloud = Eigen::Isometry3d::Identity();
};

// A question about a cloud, or several. Angles in radians, lengths in metres.
struct QueryOptions {
  Profile profile = Profile::kRobust;
  std::vector<std::string> scenes;  // empty: all
  std::uint32_t top = 3;            // 1 to kMostHypotheses
  double min_confidence = 0.5;
  std::optional<Eigen::Vector3d> up;  // direction against gravity, sensor frame, any length > 0
  std::optional<Eigen::Isometry3d> prior_T_scene_sensor;
  double prior_radius_m = 0.0;              // with a prior: how far the sensor may be from it
  std::optional<KeypointMethod> keypoints;  // unset: as the profile says
  Measure measure = Measure::kL2;
  Search search = Search::kExact;
  double ratio = 0.7;           // of the ratio filter
  std::vector<Filter> filters;  // empty: as the profile says
  Solver solver = Solver::kSimilarity;
  bool estimate_scale = false;
  std::uint64_t seed = 1;
  bool want_correspondences = false;  // fill QueryResult::correspondences
  bool explain = false;               // fill QueryResult::explanation
  // Fill QueryResult::scene_views with up to so many points each; 0: none.
  std::uint32_t want_scene_points = 0;
};

enum class QueryStatus { kLocalized, kAmbiguous, kNotFound };

// How many pairs each filter of the winning hypothesis left.
struct CorrespondenceCounts {
  std::uint32_t putative = 0, after_ratio = 0, after_slope = 0, after_consistency = 0, inliers = 0;
};

struct Fit {
  double overlap = 0.0;  // share of the query points that lie on the entry's surface
  double rmse_m = 0.0;   // of those points, to the surface
  // Of the directions in which the entry predicts a range: the sensor saw through its surface
  // there, and the range measured agrees. Of the directions measured: the entry predicts one at
  // all.
  double free_space_violation = 0.0;
  double explained = 0.0;
  double coverage = 0.0;
  double quality = 0.0;   // 0..1: overlap and agreement as one figure; what poses are ranked by
  double margin = 0.0;    // 0..1: how far ahead of the best different pose
  double agreeing = 0.0;  // keypoints of which a descriptor pair agrees with the pose
  double contrast = 0.0;  // -1..1: of the points that fit the pose and its nearest rival unlike
  // Of the directions predicted, of an object those that nothing hides: amid others that are
  // contradicted too.
  double contradicted = 0.0;
  double refuted = 0.0;        // of the query points: where the entry's scanner looked through
  double observability = 0.0;  // 0..1: weakest of the six freedoms against the strongest
  double outgrown = 0.0;       // of an object's outline: the surface seen goes on flush beyond it
  // Of an object's surface that must be seen: how many points, how closely it lies on the surface
  // measured and how evenly the normals there are spread (0..1).
  double seen_points = 0.0;
  double closeness = 0.0;
  double structure = 0.0;
  double confirmed = 0.0;  // of its keypoints that must be seen: a descriptor pair agrees
  double continued = 0.0;  // of its outline: the surface measured goes on beyond at the same range
};

// T_scene_sensor = T_icp * T_scene_landmark * T_landmark_sensor, exactly.
struct PoseChain {
  Eigen::Matrix4d T_landmark_sensor = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d T_scene_landmark = Eigen::Matrix4d::Identity();  // a similarity
  Eigen::Matrix4d T_icp = Eigen::Matrix4d::Identity();
  double scale = 1.0;
};

struct Hypothesis {
  std::string scene;
  std::int64_t scene_version = 0;
  std::optional<std::string> landmark;
  double confidence = 0.0;
  Eigen::Matrix4d T_scene_sensor = Eigen::Matrix4d::Identity();
  PoseChain chain;
  CorrespondenceCounts counts;
  Fit fit;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();  // x y z rx ry rz
  bool rival = false;  // explains the query about as well as the best one, which is none itself
};

// One putative pair of the winning entry, and which filter dropped it ("" = an inlier).
struct CorrespondenceRecord {
  std::string scene;
  Eigen::Vector3f sensor_m;
  Eigen::Vector3d scene_m;
  float distance = 0.0F;
  std::string dropped_by;
};

struct QueryCounts {
  std::uint64_t points = 0, points_used = 0, invalid = 0, keypoints = 0;
  double density_ratio = 1.0;
};

struct QueryResult {
  QueryStatus status = QueryStatus::kNotFound;
  std::string reason;                  // for kNotFound: which stage had nothing left
  std::vector<Hypothesis> hypotheses;  // best first
  QueryCounts query;
  std::uint64_t seed = 1;
  std::vector<std::string> warnings;
  std::vector<CorrespondenceRecord> correspondences;
  std::optional<Explanation> explanation;
  std::vector<SceneView> scene_views;  // one each of the first hypotheses
  StageTimings timings;
};

}  // namespace landmarkdb
