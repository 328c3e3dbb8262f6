#include "engine/mono/find_features.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "engine/base/random.hpp"
#include "tests/unit/engine/mono/paint.hpp"

namespace landmarkdb {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kDegree = std::numbers::pi / 180.0;

// A bright square of half side `half` about (u, v), turned by `angle`.
struct Square {
  double u = 0.0, v = 0.0, half = 0.0, angle = 0.0;

  bool holds(double x, double y) const {
    const double c = std::cos(angle), s = std::sin(angle);
    return std::abs(c * (x - u) + s * (y - v)) < half &&
           std::abs(-s * (x - u) + c * (y - v)) < half;
  }
  Eigen::Vector2d corner(int i) const {
    const double a = angle + (45.0 + 90.0 * i) * kDegree;
    return {u + half * std::sqrt(2.0) * std::cos(a), v + half * std::sqrt(2.0) * std::sin(a)};
  }
};

std::vector<ImageFeature> of_type(const ImageFeatures& features, FeatureType type) {
  std::vector<ImageFeature> found;
  for (const ImageFeature& point : features.points) {
    if (point.type == type) found.push_back(point);
  }
  return found;
}

// The index of the nearest point of the type; -1 if there is none within 5 px.
int nearest(const ImageFeatures& features, FeatureType type, const Eigen::Vector2d& place) {
  int best = -1;
  double away = 5.0;
  for (std::size_t i = 0; i < features.points.size(); ++i) {
    const double distance = (features.points[i].uv - place).norm();
    if (features.points[i].type == type && distance < away) {
      away = distance;
      best = static_cast<int>(i);
    }
  }
  return best;
}

bool linked(const ImageFeatures& features, int a, int b) {
  const std::array<std::uint32_t, 2> pair{static_cast<std::uint32_t>(std::min(a, b)),
                                          static_cast<std::uint32_t>(std::max(a, b))};
  return std::find(features.links.begin(), features.links.end(), pair) != features.links.end();
}

TEST(FindImageFeatures, FindsTheCornersOfASquareToATenthOfAPixel) {
  for (const double angle : {0.0, 0.2, 0.5, 0.77}) {
    const Square square{60.3, 50.7, 25.2, angle};
    const GreyImage image = testing::paint(
        120, 100, [&](double x, double y) { return square.holds(x, y) ? 180.0 : 60.0; });
    const ImageFeatures features = find_image_features(image, {}, {});
    ASSERT_EQ(of_type(features, FeatureType::kVertex).size(), 4U) << angle;
    std::vector<int> corners;
    for (int i = 0; i < 4; ++i) {
      corners.push_back(nearest(features, FeatureType::kVertex, square.corner(i)));
      ASSERT_GE(corners.back(), 0);
      const ImageFeature& found = features.points[static_cast<std::size_t>(corners.back())];
      EXPECT_LT((found.uv - square.corner(i)).norm(), 0.12) << angle;
      EXPECT_LT(found.sigma_px, 0.5);
      EXPECT_EQ(found.directions.size(), 2U);
      for (const double direction : found.directions) {
        const Eigen::Vector2d inside =
            found.uv + 10.0 * Eigen::Vector2d(std::cos(direction), std::sin(direction));
        EXPECT_LT((inside - Eigen::Vector2d(square.u, square.v)).norm(),
                  (found.uv - Eigen::Vector2d(square.u, square.v)).norm())
            << "directions point away from the corner, along the sides";
      }
    }
    for (int i = 0; i < 4; ++i) {
      EXPECT_TRUE(linked(features,
                         corners[static_cast<std::size_t>(i)],
                         corners[static_cast<std::size_t>((i + 1) % 4)]));
    }
    EXPECT_FALSE(linked(features, corners[0], corners[2]));
    const int middle = nearest(features, FeatureType::kCentroid, {square.u, square.v});
    ASSERT_GE(middle, 0);
    EXPECT_LT(
        (features.points[static_cast<std::size_t>(middle)].uv - Eigen::Vector2d(square.u, square.v))
            .norm(),
        0.15);
  }
}

// It was lost: every chain had to have a point 11 times above what noise makes of the gradient.
TEST(FindImageFeatures, FindsTheCornersOfASquareThreeTimesBrighterThanTheNoise) {
  constexpr double kNoise = 3.0;
  const Square square{70.3, 60.7, 40.2, 0.3};
  GreyImage image = testing::paint(140, 120, [&](double x, double y) {
    return square.holds(x, y) ? 100.0 + 3.0 * kNoise : 100.0;
  });
  Random random(5);
  for (std::uint8_t& pixel : image.pixels)
    pixel = static_cast<std::uint8_t>(std::lround(pixel + kNoise * random.normal()));
  const ImageFeatures features = find_image_features(image, {}, {});
  for (int i = 0; i < 4; ++i) {
    const int found = nearest(features, FeatureType::kVertex, square.corner(i));
    ASSERT_GE(found, 0) << i;
    EXPECT_LT((features.points[static_cast<std::size_t>(found)].uv - square.corner(i)).norm(), 1.5);
  }
}

TEST(FindImageFeatures, PutsTheBrightSideOfASegmentOnTheLeft) {
  const GreyImage image =
      testing::paint(80, 60, [](double x, double y) { return y < 20.0 + 0.3 * x ? 200.0 : 50.0; });
  const ImageFeatures features = find_image_features(image, {}, {});
  ASSERT_EQ(features.segments.size(), 1U);
  // Brighter above: left of a segment that runs to the right, as the screen shows it.
  EXPECT_GT(features.segments[0].to.x(), features.segments[0].from.x());
  ASSERT_FALSE(features.edges.empty());
  for (const EdgePoint& edge : features.edges) {
    EXPECT_NEAR(edge.uv.y(), 20.0 + 0.3 * edge.uv.x(), 0.15);
    EXPECT_LT(edge.normal.y(), 0.0F);
  }
}

TEST(FindImageFeatures, FindsTheCrossingsOfAChessboardWithFourDirections) {
  constexpr double kSide = 24.0;
  const GreyImage image = testing::paint(160, 130, [](double x, double y) {
    const double c = std::cos(0.3), s = std::sin(0.3);
    const auto column = static_cast<int>(std::floor((c * x + s * y) / kSide));
    const auto row = static_cast<int>(std::floor((-s * x + c * y) / kSide));
    return (column + row) % 2 == 0 ? 220.0 : 30.0;
  });
  const ImageFeatures features = find_image_features(image, {}, {});
  int inside = 0;
  for (int i = -10; i < 20; ++i) {
    for (int j = -10; j < 20; ++j) {
      const Eigen::Vector2d cross(kSide * (std::cos(0.3) * i - std::sin(0.3) * j),
                                  kSide * (std::sin(0.3) * i + std::cos(0.3) * j));
      if (cross.x() < 20 || cross.y() < 20 || cross.x() > 140 || cross.y() > 110) continue;
      ++inside;
      const int found = nearest(features, FeatureType::kVertex, cross);
      ASSERT_GE(found, 0) << cross.transpose();
      const ImageFeature& vertex = features.points[static_cast<std::size_t>(found)];
      EXPECT_LT((vertex.uv - cross).norm(), 0.1);
      EXPECT_EQ(vertex.directions.size(), 4U);
    }
  }
  EXPECT_GT(inside, 15);
}

TEST(FindImageFeatures, FindsTheCentreOfADisc) {
  Random random(3);
  for (int round = 0; round < 10; ++round) {
    const double u = random.uniform(45.0, 55.0), v = random.uniform(45.0, 55.0);
    const double a = random.uniform(12.0, 35.0), b = a * random.uniform(0.5, 1.0);
    const double angle = random.uniform(0.0, 3.0), c = std::cos(angle), s = std::sin(angle);
    const GreyImage image = testing::paint(100, 100, [&](double x, double y) {
      const double p = (c * (x - u) + s * (y - v)) / a, q = (-s * (x - u) + c * (y - v)) / b;
      return p * p + q * q < 1.0 ? 40.0 : 190.0;
    });
    const ImageFeatures features = find_image_features(image, {}, {});
    ASSERT_EQ(features.ellipses.size(), 1U);
    EXPECT_LT((features.ellipses[0].center - Eigen::Vector2d(u, v)).norm(), 0.1);
    EXPECT_NEAR(features.ellipses[0].major_px, a, 0.25);
    EXPECT_NEAR(features.ellipses[0].minor_px, b, 0.25);
    EXPECT_GT(features.ellipses[0].arc_rad, 340.0 * kDegree);
    const std::vector<ImageFeature> centres = of_type(features, FeatureType::kConicCentre);
    ASSERT_EQ(centres.size(), 1U);
    EXPECT_EQ(features.points.size(), 1U) << "a disc has no corners, and no other centre";
  }
}

TEST(FindImageFeatures, FindsTheInflexionOfAWave) {
  const GreyImage image = testing::paint(200, 100, [](double x, double y) {
    return y < 50.0 + 20.0 * std::sin((x - 100.0) / 25.0) ? 200.0 : 60.0;
  });
  const ImageFeatures features = find_image_features(image, {}, {});
  const int middle = nearest(features, FeatureType::kInflexion, {100.0, 50.0});
  ASSERT_GE(middle, 0);
  EXPECT_LT(
      (features.points[static_cast<std::size_t>(middle)].uv - Eigen::Vector2d(100.0, 50.0)).norm(),
      4.0);
}

Camera bending_camera() {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 300.0;
  camera.cx = 160.0;
  camera.cy = 120.0;
  camera.dist = {-0.25, 0.0, 0.0, 0.0, 0.0};
  return camera;
}

TEST(FindImageFeatures, FitsLinesWhereTheLensIsStraightAndAnswersInPixelsOfTheImage) {
  const Camera camera = bending_camera();
  const Square square{140.0, 105.0, 90.0, 0.1};  // in straight pixels
  const GreyImage image = testing::paint(320, 240, [&](double x, double y) {
    const std::optional<Eigen::Vector2d> ray = undistort(camera, {x, y});
    return ray && square.holds(300.0 * ray->x() + 160.0, 300.0 * ray->y() + 120.0) ? 180.0 : 60.0;
  });
  const auto worst_corner = [&](const FeatureSearchOptions& options) {
    const ImageFeatures features = find_image_features(image, options, {});
    double worst = 0.0;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d straight = square.corner(i);
      const Eigen::Vector2d corner =
          distort(camera, {(straight.x() - 160.0) / 300.0, (straight.y() - 120.0) / 300.0});
      const int found = nearest(features, FeatureType::kVertex, corner);
      worst = std::max(
          worst,
          found < 0 ? 99.0 : (features.points[static_cast<std::size_t>(found)].uv - corner).norm());
    }
    return worst;
  };
  FeatureSearchOptions with;
  with.camera = camera;
  EXPECT_LT(worst_corner(with), 0.15);
  EXPECT_GT(worst_corner({}), 0.3) << "without the camera bent lines are placed worse";
}

TEST(FindImageFeatures, FindsNothingInAnEvenImageOrOneTooSmall) {
  for (const auto& [width, height] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {640, 480}, {1, 1}, {1, 50}, {50, 1}, {2, 2}, {0, 0}}) {
    GreyImage image{width, height, std::vector<std::uint8_t>(std::size_t{width} * height, 0)};
    const ImageFeatures features = find_image_features(image, {}, {});
    EXPECT_EQ(features.width, width);
    EXPECT_TRUE(features.points.empty());
    EXPECT_TRUE(features.edges.empty());
  }
}

GreyImage noise_image(std::uint32_t width, std::uint32_t height) {
  GreyImage image{width, height, {}};
  Random random(5);
  for (std::size_t i = 0; i < std::size_t{width} * height; ++i) {
    image.pixels.push_back(static_cast<std::uint8_t>(random.below(256)));
  }
  return image;
}

TEST(FindImageFeatures, IsHardlyFooledByNoise) {
  const ImageFeatures features = find_image_features(noise_image(320, 240), {}, {});
  EXPECT_LT(features.points.size(), 20U);
  Random random(6);
  const Square square{100.0, 80.0, 40.0, 0.3};
  GreyImage image = testing::paint(
      200, 160, [&](double x, double y) { return square.holds(x, y) ? 150.0 : 90.0; });
  for (std::uint8_t& pixel : image.pixels) {
    pixel = static_cast<std::uint8_t>(pixel + 4.0 * random.normal());
  }
  const ImageFeatures noisy = find_image_features(image, {}, {});
  for (int i = 0; i < 4; ++i) {
    const int found = nearest(noisy, FeatureType::kVertex, square.corner(i));
    ASSERT_GE(found, 0);
    EXPECT_LT((noisy.points[static_cast<std::size_t>(found)].uv - square.corner(i)).norm(), 0.6);
  }
}

TEST(FindImageFeatures, KeepsWithinItsLimitsTheSameWayEveryTime) {
  FeatureSearchOptions options;
  options.low_contrast = 1.0;  // everything is an edge
  options.min_chain_points = 3;
  options.min_segment_px = 2.0;
  options.max_points = 10;
  options.max_segments = 100;
  options.max_ellipses = 10;
  options.max_edges = 40'000;
  const GreyImage image = noise_image(320, 240);
  const ImageFeatures first = find_image_features(image, options, {});
  const ImageFeatures second = find_image_features(image, options, {});
  EXPECT_EQ(first.points.size(), 10U);
  EXPECT_LE(first.segments.size(), 100U);
  EXPECT_LE(first.ellipses.size(), 10U);
  EXPECT_LE(first.edges.size(), 40'000U);
  options.max_edges = 100;
  EXPECT_LE(find_image_features(image, options, {}).edges.size(), 100U);
  ASSERT_EQ(second.points.size(), first.points.size());
  for (std::size_t i = 0; i < first.points.size(); ++i) {
    EXPECT_EQ(first.points[i].uv, second.points[i].uv);
  }
  for (const auto& [a, b] : first.links) {
    EXPECT_LT(a, b);
    EXPECT_LT(b, first.points.size());
  }
}

TEST(FindImageFeatures, StopsAtTheDeadline) {
  RunContext run;
  run.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_THAT([&] { find_image_features(noise_image(64, 64), {}, run); },
              ThrowsMessage<Error>(HasSubstr("features")));
}

TEST(FindImageFeatures, RefusesWhatDoesNotFitTogether) {
  EXPECT_THAT(
      [] {
        find_image_features({4, 4, std::vector<std::uint8_t>(15)}, {}, {});
      },
      ThrowsMessage<Error>(HasSubstr("15 pixels, want 4 x 4")));
  FeatureSearchOptions options;
  options.camera = bending_camera();
  EXPECT_THAT([&] { find_image_features(noise_image(64, 64), options, {}); },
              ThrowsMessage<Error>(HasSubstr("64 x 64 pixels, but the camera is for 320 x 240")));
}

}  // namespace
}  // namespace landmarkdb
