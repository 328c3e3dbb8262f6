#include "engine/mono/fit_ellipse.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

ImageEllipse ellipse(double u, double v, double major, double minor, double angle) {
  ImageEllipse e;
  e.center = {u, v};
  e.major_px = major;
  e.minor_px = minor;
  e.angle_rad = angle;
  return e;
}

// Points at even steps of the eccentric angle, with their normals, each with noise.
std::vector<EdgePoint> points_on(const ImageEllipse& e,
                                 int count,
                                 double from,
                                 double arc,
                                 const EdgeNoise& noise,
                                 Random& random) {
  std::vector<EdgePoint> points;
  const double c = std::cos(e.angle_rad), s = std::sin(e.angle_rad);
  for (int i = 0; i < count; ++i) {
    const double t = from + arc * i / count;
    const Eigen::Vector2d on(e.major_px * std::cos(t), e.minor_px * std::sin(t));
    const Eigen::Vector2d normal(std::cos(t) / e.major_px, std::sin(t) / e.minor_px);
    const double angle =
        std::atan2(normal.y(), normal.x()) + e.angle_rad + noise.direction_rad * random.normal();
    const Eigen::Vector2d uv =
        e.center + Eigen::Vector2d(c * on.x() - s * on.y(), s * on.x() + c * on.y()) +
        noise.position_px * Eigen::Vector2d(random.normal(), random.normal());
    points.push_back(
        {uv.cast<float>(), Eigen::Vector2d(std::cos(angle), std::sin(angle)).cast<float>()});
  }
  return points;
}

constexpr EdgeNoise kExact{0.0, 0.0};

TEST(FitEllipse, IsExactOnExactPointsWhereverTheyAre) {
  Random random(1);
  for (int round = 0; round < 500; ++round) {
    const double major = random.uniform(10.0, 80.0);
    const ImageEllipse truth = ellipse(random.uniform(-300.0, 300.0),
                                       random.uniform(-300.0, 300.0),
                                       major,
                                       major * random.uniform(0.3, 0.95),
                                       random.uniform(-1.5, 1.5));
    const std::vector<EdgePoint> points =
        points_on(truth, 40, random.uniform(0.0, 6.0), random.uniform(2.0, 6.28), kExact, random);
    const std::optional<EllipseFit> fit = fit_ellipse(points, {0.5, 2.0 * kDegree});
    ASSERT_TRUE(fit);
    EXPECT_NEAR((fit->ellipse.center - truth.center).norm(), 0.0, 2e-3);
    EXPECT_NEAR(fit->ellipse.major_px, truth.major_px, 2e-3);
    EXPECT_NEAR(fit->ellipse.minor_px, truth.minor_px, 2e-3);
    EXPECT_NEAR(
        std::remainder(fit->ellipse.angle_rad - truth.angle_rad, std::numbers::pi), 0.0, 2e-3);
    EXPECT_LT(fit->ellipse.rms_px, 1e-3);
  }
}

TEST(FitEllipse, HasTheCoefficientsOfTheWorkedExample) {
  Random random(1);
  const ImageEllipse truth = ellipse(20.0, -10.0, 60.0, 35.0, 0.5);
  const Eigen::Matrix<double, 6, 1> wanted{
      1.12393173, -0.73545848, 0.65169927, 0.74375608, -0.66845111, -0.4410975};
  EXPECT_LT((conic_of(truth, 50.0) - wanted).cwiseAbs().maxCoeff(), 1e-7);
  const std::vector<EdgePoint> points =
      points_on(truth, 60, 0.0, 2.0 * std::numbers::pi, kExact, random);
  const std::optional<EllipseFit> fit = fit_ellipse(points, {0.5, 2.0 * kDegree});
  ASSERT_TRUE(fit);
  EXPECT_LT((conic_of(fit->ellipse, 50.0) - wanted).cwiseAbs().maxCoeff(), 1e-5);
}

struct Rms {
  double center = 0.0;
  double sigma = 0.0;  // as the fit itself says
  int failed = 0;
};

// The arc starts at the end of the major axis, as in the published comparison.
Rms monte_carlo(double arc, double distance_px) {
  constexpr int kTrials = 1600;
  const EdgeNoise noise{0.5, 2.0 * kDegree};
  Random random(7);
  Rms rms;
  for (int trial = 0; trial < kTrials; ++trial) {
    const ImageEllipse truth = ellipse(distance_px, 0.0, 60.0, 35.0, 0.5);
    const std::optional<EllipseFit> fit =
        fit_ellipse(points_on(truth, 60, 0.0, arc, noise, random), noise);
    if (!fit) {
      ++rms.failed;
      continue;
    }
    rms.center += (fit->ellipse.center - truth.center).squaredNorm();
    rms.sigma += fit->center_sigma_px * fit->center_sigma_px;
  }
  rms.center = std::sqrt(rms.center / kTrials);
  rms.sigma = std::sqrt(rms.sigma / kTrials);
  return rms;
}

TEST(FitEllipse, FindsTheCentreOfAHalfArcToAThirdOfAPixel) {
  const Rms half = monte_carlo(std::numbers::pi * 60.0 / 59.0, 20.0);  // both ends are points
  EXPECT_EQ(half.failed, 0);
  EXPECT_LT(half.center, 0.32);
  RecordProperty("half_arc_center_rms_px", std::to_string(half.center));
  const Rms full = monte_carlo(2.0 * std::numbers::pi, 20.0);
  EXPECT_EQ(full.failed, 0);
  EXPECT_LT(full.center, 0.135);
  RecordProperty("full_center_rms_px", std::to_string(full.center));
}

TEST(FitEllipse, IsAsGoodAtTheOrigin) {
  const Rms away = monte_carlo(std::numbers::pi, 200.0), at = monte_carlo(std::numbers::pi, 0.0);
  EXPECT_NEAR(at.center, away.center, 0.01);
}

TEST(FitEllipse, SaysHowGoodItsCentreIs) {
  for (const double arc : {std::numbers::pi, 2.0 * std::numbers::pi}) {
    const Rms rms = monte_carlo(arc, 20.0);
    EXPECT_GT(rms.sigma, 0.6 * rms.center);
    EXPECT_LT(rms.sigma, 1.2 * rms.center);
  }
}

TEST(FitEllipse, ReturnsNothingForWhatIsNoEllipse) {
  std::vector<EdgePoint> line;
  for (int i = 0; i < 30; ++i) {
    line.push_back({{static_cast<float>(i), 2.0F * static_cast<float>(i)}, {0.894F, -0.447F}});
  }
  const std::optional<EllipseFit> flat = fit_ellipse(line, {});
  EXPECT_TRUE(!flat || flat->ellipse.minor_px < 0.05 * flat->ellipse.major_px);
  EXPECT_FALSE(fit_ellipse({}, {}));
  EXPECT_FALSE(fit_ellipse(std::vector<EdgePoint>(20, {{3.0F, 4.0F}, {1.0F, 0.0F}}), {}));
  EXPECT_FALSE(fit_ellipse(std::span(line).first(5), {}));
  std::vector<EdgePoint> broken = line;
  broken[3].uv.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(fit_ellipse(broken, {}));
  std::vector<EdgePoint> hyperbola;
  for (int i = -15; i <= 15; ++i) {
    const float x = 4.0F * static_cast<float>(i), y = std::sqrt(400.0F + x * x);
    hyperbola.push_back({{x, y}, Eigen::Vector2f(-x, y).normalized()});
  }
  EXPECT_FALSE(fit_ellipse(hyperbola, {0.1, 0.01}));
}

TEST(ArcOf, IsTheAngleThatPointsCover) {
  Random random(1);
  const ImageEllipse e = ellipse(50.0, 60.0, 40.0, 20.0, 0.3);
  const std::vector<EdgePoint> quarter = points_on(e, 91, 1.0, 91.0 * kDegree, kExact, random);
  EXPECT_NEAR(arc_of(e, quarter), 90.0 * kDegree, 0.01);
  EXPECT_EQ(arc_of(e, {}), 0.0);
}

}  // namespace
}  // namespace landmarkdb
