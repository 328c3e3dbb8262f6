#include "client/report/report.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/report/drawing.hpp"
#include "engine/base/random.hpp"

namespace landmarkdb::client {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kHostile = "</script><script>alert(1)</script>\"'&<img src=x>";

// A wall of points in front of a camera.
PointCloud wall(std::size_t count) {
  Random random(3);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    cloud.points.emplace_back(static_cast<float>(random.uniform(-2.0, 2.0)),
                              static_cast<float>(random.uniform(-1.5, 1.5)),
                              static_cast<float>(random.uniform(3.0, 4.0)));
  }
  return cloud;
}

QueryResult found(const std::string& scene) {
  QueryResult result;
  result.status = QueryStatus::kLocalized;
  Hypothesis& h = result.hypotheses.emplace_back();
  h.scene = scene;
  h.confidence = 0.93;
  h.T_scene_sensor.topRightCorner<3, 1>() = Eigen::Vector3d(500'000.0, 20.0, 1.5);
  SceneView& view = result.scene_views.emplace_back();
  view.points = wall(500).points;
  view.origin = {500'000.0, 20.0, 0.0};
  view.scene_points = 9'000;
  view.spacing_m = 0.05;
  result.correspondences.push_back({scene, {0, 0, 3}, {500'000.0, 20.0, 4.5}, 0.1F, ""});
  result.correspondences.push_back({scene, {0, 0, 3}, {500'001.0, 20.0, 4.5}, 0.2F, "ratio"});
  return result;
}

std::string between(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from);
  if (begin == text.npos) return {};
  const std::size_t start = begin + from.size();
  return text.substr(start, text.find(to, start) - start);
}

nlohmann::json data_of(const std::string& html) {
  return nlohmann::json::parse(
      between(html, "<script type=\"application/json\" id=\"data\">", "</script>"));
}

TEST(Report, SaysTheVerdictAndHoldsWhatThePageDraws) {
  const QueryResult result = found("lobby");
  const std::string html = report_html({"view.ply", wall(1000), {}}, result);
  EXPECT_THAT(html, AllOf(HasSubstr("Localized in <bdi>lobby</bdi>"), HasSubstr("view.ply")));
  EXPECT_THAT(html, AllOf(HasSubstr("T_landmark_sensor"), HasSubstr("<svg"), HasSubstr("0.93")));
  const nlohmann::json data = data_of(html);
  EXPECT_THAT(data["candidates"], SizeIs(1));
  EXPECT_EQ(data["candidates"][0]["pairs"]["inliers"][0].size(), 6U);
  EXPECT_THAT(data["candidates"][0]["pairs"]["rejected"], SizeIs(1));
  EXPECT_EQ(data["candidates"][0]["place"]["xyz"].get<std::string>().size(), 500U * 6 / 3 * 4);
  EXPECT_EQ(data["frustum"].size(), 5U);
}

TEST(Report, LetsNoNameOutOfItsText) {
  QueryResult result = found(kHostile);
  result.hypotheses[0].landmark = kHostile;
  result.warnings = {kHostile};
  result.reason = kHostile;
  Explanation& why = result.explanation.emplace();
  why.funnel = {{kHostile, 3}};
  why.scenes = {{.scene = kHostile, .steps = {{kHostile, 1}}, .best_quality = 0.1},
                {.scene = kHostile, .steps = {}, .best_quality = 0.1}};
  why.candidates.emplace_back().scene = kHostile;
  why.candidates[0].terms = {{.name = kHostile, .value = 1, .ideal = 1, .worth = 9, .cost = 9}};
  why.lost_at = kHostile;
  why.why = std::string("x") + kHostile;
  why.remedies = {{.option = kHostile, .value = kHostile, .effect = kHostile}};
  QueryOptions options;
  options.scenes = {kHostile};
  const std::string html = report_html({kHostile, wall(100), options}, result);
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  // The two scripts of the page, and their ends.
  std::size_t ends = 0;
  for (std::size_t at = html.find("</script>"); at != html.npos;
       at = html.find("</script>", at + 1)) {
    ++ends;
  }
  EXPECT_EQ(ends, 2U);
}

TEST(Report, RefersToNothingOutside) {
  const std::string html = report_html({"view.ply", wall(100), {}}, found("lobby"));
  for (const char* word : {"http:", "https:", "src=", "@import", "url(", "fetch(", "XMLHttp"}) {
    EXPECT_THAT(html, Not(HasSubstr(word))) << word;
  }
  EXPECT_THAT(html, HasSubstr("default-src 'none'"));
}

TEST(Report, IsTheSameForTheSameAnswer) {
  const QueryResult result = found("lobby");
  EXPECT_EQ(report_html({"view.ply", wall(100), {}}, result),
            report_html({"view.ply", wall(100), {}}, result));
}

TEST(Report, StaysSmallForALargeCloud) {
  QueryResult result = found("lobby");
  result.scene_views[0].points = wall(40'000).points;
  const std::string html = report_html({"view.ply", wall(300'000), {}}, result);
  EXPECT_LT(html.size(), 1'200'000U);
}

TEST(Report, DrawsTheCloudAloneWhereNothingWasFound) {
  QueryResult result;
  result.reason = "keypoints: nothing";
  const std::string html = report_html({"view.ply", wall(100), {}}, result);
  EXPECT_THAT(html, AllOf(HasSubstr("Not found"), HasSubstr("keypoints: nothing")));
  EXPECT_THAT(html, HasSubstr("drawn alone"));
  EXPECT_THAT(data_of(html)["candidates"], IsEmpty());
}

TEST(Report, IsMadeOfAnEmptyCloudToo) {
  PointCloud empty;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  empty.points.assign(10, Eigen::Vector3f(nan, nan, nan));
  const std::string html = report_html({"view.ply", empty, {}}, {});
  EXPECT_THAT(html, HasSubstr("Not found"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(Drawing, HoldsABoundedNumberOfPointsAndPairs) {
  QueryResult result = found("lobby");
  result.correspondences.assign(5'000, result.correspondences[1]);
  result.correspondences.resize(9'000, found("lobby").correspondences[0]);
  const Drawing drawing = make_drawing(wall(100'000), std::nullopt, result);
  EXPECT_LE(drawing.query.size(), kMostDrawnQueryPoints);
  EXPECT_GT(drawing.query.size(), kMostDrawnQueryPoints / 4);
  EXPECT_THAT(drawing.candidates.at(0).inliers, SizeIs(kMostDrawnPairs));
  EXPECT_THAT(drawing.candidates.at(0).rejected, SizeIs(kMostDrawnPairs));
}

TEST(Drawing, TakesACloudAllRoundForALasers) {
  PointCloud round = wall(100);
  for (const Eigen::Vector3f& point : wall(100).points) round.points.push_back(-point);
  EXPECT_THAT(make_drawing(round, std::nullopt, {}).frustum, SizeIs(1));
  EXPECT_EQ(make_drawing(round, std::nullopt, {}).up, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(make_drawing(wall(100), std::nullopt, {}).up, Eigen::Vector3d(0, -1, 0));
}

}  // namespace
}  // namespace landmarkdb::client
