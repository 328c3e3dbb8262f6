#include "engine/retrieval/localizer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <stop_token>
#include <utility>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/support/normalised_error.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using ::testing::Contains;
using testing::describe;
using testing::describe_room;
using testing::Frame;
using testing::frame_in;
using ::testing::HasSubstr;
using testing::localizer_of;
using testing::moved;
using ::testing::Not;
using testing::PoseNear;
using testing::small_room;
using ::testing::StartsWith;
using testing::SyntheticScene;

constexpr double kNear_m = 0.05;
constexpr double kNear_rad = 0.035;

// One room and what searches it, made once for all tests of a run.
struct Lobby {
  SyntheticScene scene = small_room(2);
  SceneRecord record = describe_room("lobby", scene);
  std::unique_ptr<Localizer> localizer = localizer_of({record});
};

const Lobby& lobby() {
  static const Lobby made;
  return made;
}

RunContext threads(int count) {
  RunContext context;
  context.threads = count;
  return context;
}

ErrorCode code_of(const QueryOptions& options, const RunContext& context = {}) {
  const PointCloud cloud = frame_in(lobby().scene, 1).cloud;
  try {
    lobby().localizer->query(cloud, options, context);
  } catch (const Error& error) {
    EXPECT_STRNE(error.what(), "");
    return error.code();
  }
  ADD_FAILURE() << "no error";
  return ErrorCode::kUnknown;
}

void expect_same(const QueryResult& a, const QueryResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.warnings, b.warnings);
  EXPECT_EQ(a.query.points, b.query.points);
  EXPECT_EQ(a.query.points_used, b.query.points_used);
  EXPECT_EQ(a.query.keypoints, b.query.keypoints);
  EXPECT_EQ(a.query.density_ratio, b.query.density_ratio);
  ASSERT_EQ(a.hypotheses.size(), b.hypotheses.size());
  for (std::size_t i = 0; i < a.hypotheses.size(); ++i) {
    const Hypothesis& x = a.hypotheses[i];
    const Hypothesis& y = b.hypotheses[i];
    EXPECT_EQ(x.scene, y.scene);
    EXPECT_EQ(x.landmark, y.landmark);
    EXPECT_EQ(x.confidence, y.confidence);
    EXPECT_EQ(x.T_scene_sensor, y.T_scene_sensor);
    EXPECT_EQ(x.chain.T_icp, y.chain.T_icp);
    EXPECT_EQ(x.chain.T_scene_landmark, y.chain.T_scene_landmark);
    EXPECT_EQ(x.chain.T_landmark_sensor, y.chain.T_landmark_sensor);
    EXPECT_EQ(x.counts.putative, y.counts.putative);
    EXPECT_EQ(x.counts.inliers, y.counts.inliers);
    EXPECT_EQ(x.fit.overlap, y.fit.overlap);
    EXPECT_EQ(x.fit.rmse_m, y.fit.rmse_m);
    EXPECT_EQ(x.fit.margin, y.fit.margin);
    EXPECT_EQ(x.fit.observability, y.fit.observability);
    EXPECT_EQ(x.covariance, y.covariance);
  }
  ASSERT_EQ(a.correspondences.size(), b.correspondences.size());
  for (std::size_t i = 0; i < a.correspondences.size(); ++i) {
    EXPECT_EQ(a.correspondences[i].sensor_m, b.correspondences[i].sensor_m);
    EXPECT_EQ(a.correspondences[i].scene_m, b.correspondences[i].scene_m);
    EXPECT_EQ(a.correspondences[i].dropped_by, b.correspondences[i].dropped_by);
  }
}

TEST(Localizer, FindsWhereFramesWereTaken) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Frame frame = frame_in(lobby().scene, seed);
    const QueryResult answer = lobby().localizer->query(frame.cloud, {}, {});
    EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
    EXPECT_EQ(answer.reason, "");
    ASSERT_FALSE(answer.hypotheses.empty());
    const Hypothesis& best = answer.hypotheses[0];
    EXPECT_EQ(best.scene, "lobby");
    EXPECT_EQ(best.scene_version, 1);
    EXPECT_THAT(best.T_scene_sensor, PoseNear(frame.T_scene_sensor, kNear_m, kNear_rad));
    EXPECT_GE(best.confidence, 0.5);
    EXPECT_LE(best.confidence, 1.0);
    EXPECT_GT(best.fit.overlap, 0.8);
    EXPECT_LT(best.fit.rmse_m, 0.02);
    EXPECT_LT(best.fit.free_space_violation, 0.05);
    EXPECT_GT(best.fit.margin, 0.12);
    EXPECT_GT(answer.timings.total.count(), 0.0);
    EXPECT_THAT(answer.warnings, Not(Contains("units_suspect")));
  }
}

TEST(Localizer, StatesAnAnswerThatHoldsTogether) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options;
  options.want_correspondences = true;
  const QueryResult answer = lobby().localizer->query(frame.cloud, options, {});
  EXPECT_EQ(answer.query.points, frame.cloud.size());
  EXPECT_EQ(answer.query.points, answer.query.points_used + answer.query.invalid);
  EXPECT_GT(answer.query.keypoints, 0U);
  ASSERT_FALSE(answer.hypotheses.empty());
  double before = 2.0;
  for (const Hypothesis& h : answer.hypotheses) {
    EXPECT_TRUE(h.T_scene_sensor.isApprox(
        h.chain.T_icp * h.chain.T_scene_landmark * h.chain.T_landmark_sensor, 1e-12));
    EXPECT_NO_THROW(from_row_major(to_row_major(h.T_scene_sensor)));
    EXPECT_LE(h.fit.quality, before);
    before = h.fit.quality;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(h.covariance);
    EXPECT_TRUE(h.covariance.isApprox(h.covariance.transpose(), 1e-9));
    EXPECT_GT(solver.eigenvalues().minCoeff(), 0.0);
    EXPECT_LE(h.counts.inliers, h.counts.putative);
  }
  // The best pose is right: its error fits what it says about itself.
  const Hypothesis& best = answer.hypotheses[0];
  const Eigen::Vector3d off =
      best.T_scene_sensor.topRightCorner<3, 1>() - frame.T_scene_sensor.translation();
  const Eigen::Matrix3d C = best.covariance.topLeftCorner<3, 3>();
  EXPECT_LT(off.dot(C.inverse() * off), 30.0);
  EXPECT_LT(std::sqrt(C.trace()), 0.1);

  ASSERT_EQ(answer.correspondences.size(), best.counts.putative);
  const auto kept = std::count_if(answer.correspondences.begin(),
                                  answer.correspondences.end(),
                                  [](const auto& row) { return row.dropped_by.empty(); });
  EXPECT_EQ(static_cast<std::uint32_t>(kept), best.counts.inliers);
  for (const CorrespondenceRecord& row : answer.correspondences) {
    if (!row.dropped_by.empty()) continue;
    const Eigen::Vector4d there = best.T_scene_sensor * row.sensor_m.cast<double>().homogeneous();
    EXPECT_LT((there.head<3>() - row.scene_m).norm(), 3.0 * lobby().record.options.voxel_m + 1e-3);
  }
}

TEST(Localizer, AnswersTheSameForAnyNumberOfThreads) {
  const Frame frame = frame_in(lobby().scene, 2);
  QueryOptions options;
  options.want_correspondences = true;
  for (const Profile profile : {Profile::kRobust, Profile::kPaper}) {
    options.profile = profile;
    const QueryResult one = lobby().localizer->query(frame.cloud, options, threads(1));
    expect_same(one, lobby().localizer->query(frame.cloud, options, threads(1)));
    expect_same(one, lobby().localizer->query(frame.cloud, options, threads(2)));
    expect_same(one, lobby().localizer->query(frame.cloud, options, threads(5)));
  }
}

TEST(Localizer, DoesNotCareInWhichOrderThePointsCome) {
  Frame frame = frame_in(lobby().scene, 2);
  Random random(1);
  frame.cloud.width = frame.cloud.height = 0;
  for (std::size_t i = frame.cloud.size(); i > 1; --i) {
    std::swap(frame.cloud.points[i - 1], frame.cloud.points[random.below(i)]);
  }
  const QueryResult answer = lobby().localizer->query(frame.cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_THAT(answer.hypotheses[0].T_scene_sensor,
              PoseNear(frame.T_scene_sensor, kNear_m, kNear_rad));
}

TEST(Localizer, FindsASensorThatHangsUpsideDownOrLiesOnItsSide) {
  const Frame frame = frame_in(lobby().scene, 1);
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0, 0, 3.14159), Eigen::Vector3d(1.5, 0.4, -0.3)}) {
    Eigen::Isometry3d T_turned_sensor = Eigen::Isometry3d::Identity();
    T_turned_sensor.linear() = rotation_from_vector(turn);
    PointCloud cloud = moved(frame.cloud, T_turned_sensor);
    cloud.width = cloud.height = 0;
    QueryOptions options;
    for (const bool gravity : {false, true}) {
      if (gravity) options.up = T_turned_sensor.linear() * (7.0 * frame.up_sensor);
      const QueryResult answer = lobby().localizer->query(cloud, options, {});
      EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
      ASSERT_FALSE(answer.hypotheses.empty());
      EXPECT_THAT(answer.hypotheses[0].T_scene_sensor,
                  PoseNear(frame.T_scene_sensor * T_turned_sensor.inverse(), kNear_m, kNear_rad));
    }
  }
}

TEST(Localizer, DoesNotLocalizeAFrameOfAnotherPlace) {
  const SyntheticScene elsewhere = small_room(3);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const QueryResult answer = lobby().localizer->query(frame_in(elsewhere, seed).cloud, {}, {});
    EXPECT_NE(answer.status, QueryStatus::kLocalized);
    EXPECT_EQ(answer.reason.empty(), answer.status != QueryStatus::kNotFound);
  }
}

TEST(Localizer, NamesTheRightOneOfSeveralPlaces) {
  const SyntheticScene other = small_room(3);
  const auto both = localizer_of({describe_room("other", other), lobby().record});
  const Frame frame = frame_in(lobby().scene, 2);
  const QueryResult answer = both->query(frame.cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_EQ(answer.hypotheses[0].scene, "lobby");
  EXPECT_THAT(answer.hypotheses[0].T_scene_sensor,
              PoseNear(frame.T_scene_sensor, kNear_m, kNear_rad));

  QueryOptions only_other;
  only_other.scenes = {"other"};
  const QueryResult wrong = both->query(frame.cloud, only_other, {});
  EXPECT_NE(wrong.status, QueryStatus::kLocalized);
  for (const Hypothesis& h : wrong.hypotheses) EXPECT_EQ(h.scene, "other");
}

TEST(Localizer, CallsTwoCopiesOfAPlaceAmbiguousAndListsBoth) {
  SceneRecord copy = lobby().record;
  copy.name = "copy";
  const auto both = localizer_of({lobby().record, copy});
  const Frame frame = frame_in(lobby().scene, 1);
  const QueryResult answer = both->query(frame.cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kAmbiguous);
  ASSERT_GE(answer.hypotheses.size(), 2U);
  EXPECT_NE(answer.hypotheses[0].scene, answer.hypotheses[1].scene);
  for (const std::size_t i : {0U, 1U}) {
    EXPECT_THAT(answer.hypotheses[i].T_scene_sensor,
                PoseNear(frame.T_scene_sensor, kNear_m, kNear_rad));
  }
  QueryOptions one;
  one.scenes = {"copy"};
  EXPECT_EQ(both->query(frame.cloud, one, {}).status, QueryStatus::kLocalized);
}

TEST(Localizer, KeepsItsMillimetresFarFromZero) {
  // The same scan around an origin as a survey would give it.
  PointCloud cloud = lobby().scene.cloud;
  cloud.origin = Eigen::Vector3d(412'345.25, 5'654'321.5, 118.75);
  const auto surveyed = localizer_of({describe("surveyed", cloud, {})});
  const Frame frame = frame_in(lobby().scene, 2);
  Eigen::Isometry3d expected = frame.T_scene_sensor;
  expected.pretranslate(cloud.origin);
  const QueryResult answer = surveyed->query(frame.cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  const Hypothesis& best = answer.hypotheses[0];
  EXPECT_THAT(best.T_scene_sensor, PoseNear(expected, 0.01, 0.005));
  EXPECT_LT((best.T_scene_sensor -
             best.chain.T_icp * best.chain.T_scene_landmark * best.chain.T_landmark_sensor)
                .cwiseAbs()
                .maxCoeff(),
            1e-6);
  // The refinement stays a small motion to look at.
  EXPECT_LT(rotation_angle_rad(best.chain.T_icp.topLeftCorner<3, 3>()), 0.5);

  QueryOptions prior;
  prior.prior_T_scene_sensor = expected;
  prior.prior_radius_m = 0.5;
  EXPECT_EQ(surveyed->query(frame.cloud, prior, {}).status, QueryStatus::kLocalized);
}

TEST(Localizer, StatesACovarianceThatItsErrorsKeepTo) {
  double sum = 0.0;
  int count = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6, 7, 8}) {
    const Frame frame = frame_in(lobby().scene, seed);
    const QueryResult answer = lobby().localizer->query(frame.cloud, {}, {});
    if (answer.status != QueryStatus::kLocalized) continue;
    sum += testing::normalised_squared_error(
        answer.hypotheses[0].covariance, answer.hypotheses[0].T_scene_sensor, frame.T_scene_sensor);
    ++count;
  }
  ASSERT_GE(count, 5);
  // 1 for a sensor's noise; these frames have next to none, and a tenth of a voxel is granted.
  const double mean = sum / count;
  EXPECT_GT(mean, 0.005);
  EXPECT_LT(mean, 4.0);
}

TEST(Localizer, FindsSeveralViewsWithTheirPosesAsOne) {
  const Frame first = frame_in(lobby().scene, 1);
  const Frame second = frame_in(lobby().scene, 2);
  std::vector<QueryCloud> clouds(2);
  clouds[0].cloud = first.cloud;
  clouds[1].cloud = second.cloud;
  clouds[1].T_query_cloud = first.T_scene_sensor.inverse() * second.T_scene_sensor;
  const QueryResult answer = lobby().localizer->query(clouds, {}, {});
  ASSERT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  EXPECT_THAT(answer.hypotheses[0].T_scene_sensor,
              PoseNear(first.T_scene_sensor, kNear_m, kNear_rad));
  EXPECT_EQ(answer.query.points, first.cloud.size() + second.cloud.size());
  EXPECT_LT(answer.hypotheses[0].fit.free_space_violation, 0.05);  // of each view's own rays
}

TEST(Localizer, DoesNotBelieveViewsWhosePosesToEachOtherAreWrong) {
  std::vector<QueryCloud> clouds(2);
  clouds[0].cloud = frame_in(lobby().scene, 1).cloud;
  clouds[1].cloud = frame_in(lobby().scene, 2).cloud;
  clouds[1].T_query_cloud = Eigen::Translation3d(2.0, -1.0, 1.5);
  EXPECT_NE(lobby().localizer->query(clouds, {}, {}).status, QueryStatus::kLocalized);
}

TEST(Localizer, LooksOnlyNearThePrior) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options;
  options.prior_T_scene_sensor = frame.T_scene_sensor;
  options.prior_radius_m = 0.7;
  EXPECT_EQ(lobby().localizer->query(frame.cloud, options, {}).status, QueryStatus::kLocalized);
  options.prior_T_scene_sensor->pretranslate(Eigen::Vector3d(100, 0, 0));
  const QueryResult answer = lobby().localizer->query(frame.cloud, options, {});
  EXPECT_EQ(answer.status, QueryStatus::kNotFound);
  EXPECT_THAT(answer.reason, StartsWith("pose"));
  EXPECT_TRUE(answer.hypotheses.empty());
}

TEST(Localizer, FindsNothingInACloudThatHoldsNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PointCloud not_a_number;
  not_a_number.points.assign(1000, Eigen::Vector3f::Constant(nan));
  PointCloud few;
  few.points = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}};
  PointCloud repeated;
  repeated.points.assign(1000, Eigen::Vector3f(1, 2, 3));
  for (const PointCloud& cloud : {PointCloud{}, not_a_number, few, repeated}) {
    for (const Profile profile : {Profile::kRobust, Profile::kPaper}) {
      QueryOptions options;
      options.profile = profile;
      const QueryResult answer = lobby().localizer->query(cloud, options, {});
      EXPECT_EQ(answer.status, QueryStatus::kNotFound);
      EXPECT_THAT(answer.reason, HasSubstr("usable points"));
      EXPECT_EQ(answer.query.points, cloud.size());
      EXPECT_TRUE(answer.hypotheses.empty());
    }
  }
}

TEST(Localizer, FindsNothingInACloudThatIsALineASpeckOrAPlane) {
  Random random(1);
  PointCloud line, speck, plane;
  for (int i = 0; i < 5000; ++i) {
    const auto a = static_cast<float>(random.uniform(-2, 2));
    const auto b = static_cast<float>(random.uniform(-2, 2));
    line.points.emplace_back(a, 2 * a, 3.0F);
    speck.points.emplace_back(1e-3F * a, 1e-3F * b, 1.0F);
    plane.points.emplace_back(a, b, 2.0F);
  }
  for (const PointCloud& cloud : {line, speck, plane}) {
    for (const Profile profile : {Profile::kRobust, Profile::kPaper}) {
      QueryOptions options;
      options.profile = profile;
      const QueryResult answer = lobby().localizer->query(cloud, options, {});
      EXPECT_NE(answer.status, QueryStatus::kLocalized);
      EXPECT_EQ(answer.reason.empty(), answer.status != QueryStatus::kNotFound);
    }
  }
}

TEST(Localizer, WarnsOfACloudInMillimetres) {
  PointCloud cloud = frame_in(lobby().scene, 1).cloud;
  for (Eigen::Vector3f& p : cloud.points) p *= 1000.0F;
  const QueryResult answer = lobby().localizer->query(cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kNotFound);
  EXPECT_THAT(answer.warnings, Contains("units_suspect"));
}

TEST(Localizer, SaysThatGravityIsOfNoUseWhereTheSceneDoesNotKnowItsOwn) {
  SceneRecord record = lobby().record;
  record.up.reset();
  const auto without = localizer_of({record});
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options;
  EXPECT_THAT(without->query(frame.cloud, options, {}).warnings, Not(Contains("gravity_unknown")));
  options.up = frame.up_sensor;
  EXPECT_THAT(without->query(frame.cloud, options, {}).warnings, Contains("gravity_unknown"));
  EXPECT_THAT(lobby().localizer->query(frame.cloud, options, {}).warnings,
              Not(Contains("gravity_unknown")));
}

TEST(Localizer, HasNothingToSearchInAnEmptyDatabase) {
  const auto nothing = localizer_of({});
  const QueryResult answer = nothing->query(frame_in(lobby().scene, 1).cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kNotFound);
  EXPECT_THAT(answer.reason, HasSubstr("no scenes"));
  EXPECT_TRUE(nothing->catalog().entries.empty());
}

TEST(Localizer, RefusesOptionsThatCannotBe) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  QueryOptions options;
  options.scenes = {"lobby", "attic"};
  EXPECT_EQ(code_of(options), ErrorCode::kNotFound);
  for (const double bad : {-0.1, 1.1, nan}) {
    options = {};
    options.min_confidence = bad;
    EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
    options = {};
    options.ratio = bad;
    EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
    options = {};
    options.up = Eigen::Vector3d(0, 0, nan);
    EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  }
  options = {};
  options.filters = {Filter::kRatio};  // the robust profile uses none
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  options = {};
  options.estimate_scale = true;  // the robust profile takes both clouds as metric
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  options = {};
  options.top = 0;
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  options = {};
  options.up = Eigen::Vector3d::Zero();
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  for (const double bad : {-1.0, 0.0, nan}) {
    options = {};
    options.prior_T_scene_sensor = Eigen::Isometry3d::Identity();
    options.prior_radius_m = bad;
    EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
  }
  options.prior_radius_m = 1.0;
  options.prior_T_scene_sensor->translation().y() = nan;
  EXPECT_EQ(code_of(options), ErrorCode::kInvalidArgument);
}

TEST(Localizer, StopsWhenItIsTold) {
  std::stop_source stop;
  stop.request_stop();
  RunContext context;
  context.stop = stop.get_token();
  EXPECT_EQ(code_of({}, context), ErrorCode::kCancelled);
  RunContext late;
  late.deadline = std::chrono::steady_clock::now();
  EXPECT_EQ(code_of({}, late), ErrorCode::kDeadlineExceeded);
}

TEST(Localizer, GivesNoMoreAnswersThanAsked) {
  QueryOptions options;
  options.top = 1;
  const QueryResult answer =
      lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
  EXPECT_EQ(answer.hypotheses.size(), 1U);
}

TEST(Localizer, AnswersOrDeclinesThePapersWayButIsNeverWrong) {
  QueryOptions options;
  options.profile = Profile::kPaper;
  for (const std::uint64_t seed : {1U, 2U, 4U, 5U}) {
    const Frame frame = frame_in(lobby().scene, seed);
    const QueryResult answer = lobby().localizer->query(frame.cloud, options, {});
    for (const Hypothesis& h : answer.hypotheses) {
      EXPECT_LE(h.counts.after_ratio, h.counts.putative);
      EXPECT_LE(h.counts.after_slope, h.counts.after_ratio);
      EXPECT_LE(h.counts.after_consistency, h.counts.after_slope);
    }
    if (answer.status != QueryStatus::kLocalized) continue;
    EXPECT_THAT(answer.hypotheses[0].T_scene_sensor, PoseNear(frame.T_scene_sensor, 0.1, 0.087));
  }
  for (const std::uint64_t seed : {1U, 2U}) {
    const Frame stranger = frame_in(small_room(3), seed);
    EXPECT_NE(lobby().localizer->query(stranger.cloud, options, {}).status,
              QueryStatus::kLocalized);
  }
}

TEST(Localizer, FindsAShiftedCopyThePapersWay) {
  // Shifted by whole voxels of a power of two: the descriptors are the same but for rounding, so
  // the ratio keeps its pairs and all slopes agree.
  const SyntheticScene& room = lobby().scene;
  IndexOptions index;
  index.voxel_m = 0.0625;
  Eigen::Isometry3d T_sensor_room = Eigen::Isometry3d::Identity();
  T_sensor_room.translation() = Eigen::Vector3d(2.0, -1.0, 0.5);
  QueryOptions options;
  options.profile = Profile::kPaper;
  const PointCloud cloud = moved(room.cloud, T_sensor_room);
  for (const bool narf : {true, false}) {
    index.keypoints = narf ? KeypointMethod::kNarf : KeypointMethod::kStructure;
    const auto database = localizer_of({describe("room", room.cloud, index)});
    const QueryResult answer = database->query(cloud, options, {});
    EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
    ASSERT_FALSE(answer.hypotheses.empty());
    const Hypothesis& best = answer.hypotheses[0];
    EXPECT_THAT(best.T_scene_sensor, PoseNear(T_sensor_room.inverse(), 0.01, 0.005));
    EXPECT_LE(best.counts.after_ratio, best.counts.putative);
    if (narf) continue;
    EXPECT_GT(best.counts.after_ratio, best.counts.putative / 2);
    EXPECT_GT(best.counts.inliers, 50U);
  }
}

TEST(Localizer, FindsFramesThePapersWayWithEveryMeasureSearchSolverAndFilter) {
  std::vector<QueryOptions> ways(1);
  ways[0].profile = Profile::kPaper;
  ways[0].ratio = 0.95;  // 0.7 leaves too few pairs of so small a room
  for (const Measure measure : {Measure::kL1,
                                Measure::kChi2,
                                Measure::kIntersection,
                                Measure::kCorrelation,
                                Measure::kBhattacharyya}) {
    ways.push_back(ways[0]);
    ways.back().measure = measure;
  }
  ways.push_back(ways[0]);
  ways.back().search = Search::kFlann;
  ways.push_back(ways[0]);
  ways.back().solver = Solver::kPnp;
  ways.push_back(ways[0]);
  ways.back().filters = {Filter::kRatio, Filter::kClique};
  ways.push_back(ways[0]);
  ways.back().filters = {Filter::kSlope};
  for (std::size_t way = 0; way < ways.size(); ++way) {
    int right = 0;
    for (const std::uint64_t seed : {1U, 2U, 4U, 5U}) {
      const Frame frame = frame_in(lobby().scene, seed);
      const QueryResult answer = lobby().localizer->query(frame.cloud, ways[way], {});
      if (answer.status != QueryStatus::kLocalized) continue;
      ++right;
      EXPECT_THAT(answer.hypotheses[0].T_scene_sensor, PoseNear(frame.T_scene_sensor, 0.1, 0.087))
          << way;
      break;
    }
    EXPECT_GE(right, 1) << way;
  }
}

TEST(Localizer, RefusesASolverThatDoesNotGoWithTheRest) {
  const Frame frame = frame_in(lobby().scene, 1);
  QueryOptions options;
  options.solver = Solver::kPnp;
  EXPECT_THROW(lobby().localizer->query(frame.cloud, options, {}), Error);
  options.profile = Profile::kPaper;
  options.estimate_scale = true;
  EXPECT_THROW(lobby().localizer->query(frame.cloud, options, {}), Error);
}

TEST(Localizer, NamesTheLandmarkThatHoldsTheInliers) {
  CatalogEntry entry = lobby().localizer->catalog().entries[0];
  const Eigen::Vector3d room = lobby().scene.room_m;
  entry.landmarks.push_back(
      {"all of it", Eigen::Vector3d::Constant(-1.0), room + Eigen::Vector3d::Constant(1.0)});
  entry.landmarks.push_back({"the sky", {0, 0, 100}, {1, 1, 101}});
  auto catalog = std::make_shared<Catalog>();
  catalog->entries.push_back(entry);
  const Localizer localizer(catalog, {});
  const QueryResult answer = localizer.query(frame_in(lobby().scene, 1).cloud, {}, {});
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_EQ(answer.hypotheses[0].landmark, "all of it");
}

}  // namespace
}  // namespace landmarkdb
