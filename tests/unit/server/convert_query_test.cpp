#include "server/convert_query.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

void set_pose(v1::QueryOptions& options, const Eigen::Isometry3d& T) {
  options.clear_prior_t_scene_sensor();
  for (const double number : to_row_major(T.matrix())) options.add_prior_t_scene_sensor(number);
}

v1::QueryOptions full_options() {
  v1::QueryOptions message;
  message.set_profile(v1::PROFILE_PAPER);
  message.add_scenes("lobby");
  message.set_top(5);
  message.set_min_confidence(0.25);
  message.mutable_up()->set_z(2.0);
  set_pose(message, Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3)));
  message.set_prior_radius_m(4.0);
  message.set_keypoints(v1::KEYPOINT_METHOD_ISS);
  message.set_measure(v1::MEASURE_CHI2);
  message.set_search(v1::SEARCH_FLANN);
  message.set_ratio(0.8);
  message.add_filters(v1::FILTER_SLOPE);
  message.add_filters(v1::FILTER_RATIO);
  message.set_solver(v1::SOLVER_PNP);
  message.set_estimate_scale(true);
  message.set_seed(42);
  message.set_want_correspondences(true);
  return message;
}

v1::QueryRequest two_clouds() {
  v1::QueryRequest request;
  for (int i = 0; i < 2; ++i) {
    v1::Cloud& cloud = *request.add_clouds();
    cloud.set_encoding(v1::POINT_ENCODING_FLOAT32);
    cloud.set_points(1);
    cloud.set_xyz(std::string(12, '\0'));
    const Eigen::Isometry3d T(Eigen::Translation3d(0, 0, i));
    for (const double number : to_row_major(T.matrix())) request.add_t_query_clouds(number);
  }
  return request;
}

std::string field_refused(const v1::QueryRequest& request) {
  try {
    PointAllowance allowance;
    clouds_from_proto(request, allowance);
  } catch (const Error& error) {
    return error.field();
  }
  return "none";
}

TEST(QueryCloudsFromProto, CarryTheirPoses) {
  PointAllowance allowance;
  const std::vector<QueryCloud> clouds = clouds_from_proto(two_clouds(), allowance);
  ASSERT_THAT(clouds, SizeIs(2));
  EXPECT_EQ(clouds[1].T_query_cloud.translation(), Eigen::Vector3d(0, 0, 1));
  EXPECT_THAT(clouds[1].cloud.points, SizeIs(1));
}

TEST(QueryCloudsFromProto, StandAtTheIdentityWithoutPoses) {
  v1::QueryRequest request = two_clouds();
  request.clear_t_query_clouds();
  PointAllowance allowance;
  EXPECT_TRUE(clouds_from_proto(request, allowance)[1].T_query_cloud.matrix().isIdentity(0.0));
}

TEST(QueryCloudsFromProto, NameWhatIsWrong) {
  EXPECT_EQ(field_refused(two_clouds()), "none");
  EXPECT_EQ(field_refused({}), "clouds");
  v1::QueryRequest request = two_clouds();
  request.add_t_query_clouds(1.0);
  EXPECT_EQ(field_refused(request), "t_query_clouds");
  request = two_clouds();
  request.set_t_query_clouds(16, 2.0);  // no rotation
  EXPECT_EQ(field_refused(request), "t_query_clouds[1]");
  request = two_clouds();
  request.mutable_clouds(1)->set_xyz("short");
  EXPECT_EQ(field_refused(request), "clouds[1].xyz");
  request = two_clouds();
  while (request.clouds_size() <= static_cast<int>(kMostQueryClouds)) {
    *request.add_clouds() = request.clouds(0);
  }
  EXPECT_EQ(field_refused(request), "clouds");
}

TEST(QueryOptionsFromProto, GivesTheDefaultsForAnEmptyMessage) {
  const QueryOptions options = from_proto(v1::QueryOptions());
  const QueryOptions defaults;
  EXPECT_EQ(options.profile, defaults.profile);
  EXPECT_EQ(options.top, defaults.top);
  EXPECT_EQ(options.min_confidence, defaults.min_confidence);
  EXPECT_EQ(options.ratio, defaults.ratio);
  EXPECT_EQ(options.seed, defaults.seed);
  EXPECT_EQ(options.measure, defaults.measure);
  EXPECT_FALSE(options.keypoints.has_value());
  EXPECT_FALSE(options.up.has_value());
  EXPECT_FALSE(options.prior_T_scene_sensor.has_value());
}

TEST(QueryOptionsFromProto, CarriesEveryField) {
  const QueryOptions options = from_proto(full_options());
  EXPECT_EQ(options.profile, Profile::kPaper);
  EXPECT_THAT(options.scenes, ElementsAre("lobby"));
  EXPECT_EQ(options.top, 5U);
  EXPECT_EQ(options.min_confidence, 0.25);
  EXPECT_EQ(options.up, Eigen::Vector3d(0, 0, 2));
  EXPECT_EQ(options.prior_T_scene_sensor->translation(), Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(options.prior_radius_m, 4.0);
  EXPECT_EQ(options.keypoints, KeypointMethod::kIss);
  EXPECT_EQ(options.measure, Measure::kChi2);
  EXPECT_EQ(options.search, Search::kFlann);
  EXPECT_EQ(options.ratio, 0.8);
  EXPECT_THAT(options.filters, ElementsAre(Filter::kSlope, Filter::kRatio));
  EXPECT_EQ(options.solver, Solver::kPnp);
  EXPECT_TRUE(options.estimate_scale);
  EXPECT_EQ(options.seed, 42U);
  EXPECT_TRUE(options.want_correspondences);
}

TEST(QueryOptionsFromProto, RefusesWhatCannotBeAndNamesTheField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    std::function<void(v1::QueryOptions&)> spoil;
  };
  const std::vector<Case> cases = {
      {"options.profile", [](auto& o) { o.set_profile(v1::Profile(99)); }},
      {"options.measure", [](auto& o) { o.set_measure(v1::Measure(99)); }},
      {"options.search", [](auto& o) { o.set_search(v1::Search(-1)); }},
      {"options.keypoints", [](auto& o) { o.set_keypoints(v1::KeypointMethod(99)); }},
      {"options.filters", [](auto& o) { o.add_filters(v1::Filter(0)); }},
      {"options.filters", [](auto& o) { o.add_filters(v1::FILTER_RATIO); }},
      {"options.top", [](auto& o) { o.set_top(0); }},
      {"options.top", [](auto& o) { o.set_top(kMostHypotheses + 1); }},
      {"options.top", [](auto& o) { o.set_top(4'000'000'000U); }},
      {"options.min_confidence", [&](auto& o) { o.set_min_confidence(nan); }},
      {"options.min_confidence", [](auto& o) { o.set_min_confidence(1.5); }},
      {"options.ratio", [](auto& o) { o.set_ratio(-0.1); }},
      {"options.up", [](auto& o) { o.mutable_up()->set_z(0.0); }},
      {"options.up", [&](auto& o) { o.mutable_up()->set_x(nan); }},
      {"options.prior_radius_m", [](auto& o) { o.set_prior_radius_m(0.0); }},
      {"options.prior_radius_m", [&](auto& o) { o.set_prior_radius_m(nan); }},
      {"options.prior_radius_m", [](auto& o) { o.clear_prior_t_scene_sensor(); }},
      {"options.prior_t_scene_sensor", [](auto& o) { o.add_prior_t_scene_sensor(1.0); }},
      {"options.prior_t_scene_sensor", [&](auto& o) { o.set_prior_t_scene_sensor(3, nan); }},
      {"options.prior_t_scene_sensor", [](auto& o) { o.set_prior_t_scene_sensor(0, 2.0); }},
      {"options.prior_t_scene_sensor", [](auto& o) { o.set_prior_t_scene_sensor(15, 0.0); }},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    v1::QueryOptions message = full_options();
    cases[i].spoil(message);
    try {
      from_proto(message);
      ADD_FAILURE() << "case " << i << " was taken, " << cases[i].field;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << "case " << i;
      EXPECT_EQ(error.field(), cases[i].field) << "case " << i;
    }
  }
}

TEST(QueryOptionsFromProto, ThrowsNothingButErrorsForMutatedMessages) {
  Random random(3);
  const std::string good = full_options().SerializeAsString();
  for (int round = 0; round < 20'000; ++round) {
    std::string bytes = good;
    for (std::uint64_t edits = random.below(4) + 1; edits > 0; --edits) {
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    }
    v1::QueryOptions message;
    if (!message.ParseFromString(bytes)) continue;
    try {
      const QueryOptions options = from_proto(message);
      ASSERT_GE(options.top, 1U);
      ASSERT_LE(options.top, kMostHypotheses);
      ASSERT_TRUE(options.ratio >= 0.0 && options.ratio <= 1.0);
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::kInvalidArgument) << error.what();
    }
  }
}

TEST(QueryResultToProto, CarriesEveryFieldAndTheDerivedForms) {
  QueryResult result;
  result.status = QueryStatus::kAmbiguous;
  result.reason = "why";
  result.seed = 9;
  result.query = {
      .points = 4, .points_used = 3, .invalid = 1, .keypoints = 2, .density_ratio = 0.5};
  result.warnings = {"low_overlap"};
  result.timings.icp = StageTimings::Duration(12.5);
  result.correspondences = {{"lobby", {1, 2, 3}, {4, 5, 6}, 0.25F, "ratio"}};
  Hypothesis hypothesis;
  hypothesis.scene = "lobby";
  hypothesis.scene_version = 3;
  hypothesis.landmark = "vents";
  hypothesis.confidence = 0.75;
  const Eigen::Isometry3d T =
      Eigen::Translation3d(1, 2, 3) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ());
  hypothesis.T_scene_sensor = T.matrix();
  hypothesis.chain.T_icp = T.matrix();
  hypothesis.chain.scale = 1.25;
  hypothesis.counts = {
      .putative = 9, .after_ratio = 8, .after_slope = 7, .after_consistency = 6, .inliers = 5};
  hypothesis.fit = {.overlap = 0.9,
                    .rmse_m = 0.01,
                    .free_space_violation = 0.1,
                    .margin = 0.2,
                    .agreeing = 17.0,
                    .contrast = 0.6,
                    .contradicted = 0.05,
                    .refuted = 0.01,
                    .observability = 0.3};
  hypothesis.covariance(0, 5) = 0.125;
  result.hypotheses = {hypothesis};

  const v1::QueryResult message = to_proto(result);
  EXPECT_EQ(message.status(), v1::QUERY_STATUS_AMBIGUOUS);
  EXPECT_EQ(message.reason(), "why");
  EXPECT_EQ(message.query().seed(), 9U);
  EXPECT_EQ(message.query().invalid(), 1U);
  EXPECT_EQ(message.query().density_ratio(), 0.5);
  EXPECT_THAT(message.warnings(), ElementsAre("low_overlap"));
  EXPECT_EQ(message.timing().icp_ms(), 12.5);
  ASSERT_THAT(message.correspondences(), SizeIs(1));
  EXPECT_EQ(message.correspondences(0).scene_m().z(), 6.0);
  EXPECT_EQ(message.correspondences(0).dropped_by(), "ratio");

  ASSERT_THAT(message.hypotheses(), SizeIs(1));
  const v1::Hypothesis& h = message.hypotheses(0);
  EXPECT_EQ(h.landmark(), "vents");
  EXPECT_EQ(h.scene_version(), 3);
  ASSERT_THAT(h.t_scene_sensor(), SizeIs(16));
  EXPECT_EQ(h.t_scene_sensor(7), 2.0) << "row-major: the y of the translation ends the second row";
  EXPECT_NEAR(h.t_scene_sensor(1), -std::sin(0.5), 1e-12);
  EXPECT_EQ(h.translation_m().z(), 3.0);
  EXPECT_NEAR(h.rotation_xyzw(2), std::sin(0.25), 1e-12);
  EXPECT_NEAR(h.rotation_xyzw(3), std::cos(0.25), 1e-12);
  EXPECT_NEAR(h.roll_pitch_yaw_rad().z(), 0.5, 1e-12);
  EXPECT_EQ(h.chain().scale(), 1.25);
  EXPECT_EQ(h.chain().t_icp(3), 1.0);
  EXPECT_EQ(h.correspondences().putative(), 9U);
  EXPECT_EQ(h.correspondences().inliers(), 5U);
  EXPECT_EQ(h.fit().observability(), 0.3);
  EXPECT_EQ(h.fit().contrast(), 0.6);
  EXPECT_EQ(h.fit().contradicted(), 0.05);
  EXPECT_EQ(h.fit().refuted(), 0.01);
  EXPECT_EQ(h.fit().agreeing(), 17.0);
  ASSERT_THAT(h.covariance(), SizeIs(36));
  EXPECT_EQ(h.covariance(5), 0.125);
}

}  // namespace
}  // namespace landmarkdb
