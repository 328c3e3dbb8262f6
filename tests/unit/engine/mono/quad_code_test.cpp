#include "engine/mono/quad_code.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"

namespace landmarkdb {
namespace {

using Points = std::array<Eigen::Vector2d, 4>;

const Points kQuad{Eigen::Vector2d(0, 0), {10, 1}, {3, 2.5}, {6, -2}};

TEST(CodeQuad, DoesNotChangeWithShiftTurnAndScale) {
  QuadCode code, moved;
  ASSERT_TRUE(code_quad(kQuad, code));
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const double angle = random.uniform(0.0, 6.28), scale = random.uniform(0.1, 20.0);
    Eigen::Matrix2d T;
    T << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    const Eigen::Vector2d shift(random.normal(), random.normal());
    Points points;
    for (std::size_t k = 0; k < 4; ++k) {
      points[k] = scale * T * kQuad[k] + shift;
    }
    ASSERT_TRUE(code_quad(points, moved));
    EXPECT_EQ(moved.order, code.order);
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(moved.code[k], code.code[k], 1e-5);
  }
}

TEST(CodeQuad, DoesNotDependOnTheOrderOfThePoints) {
  QuadCode code, other;
  ASSERT_TRUE(code_quad(kQuad, code));
  const Points shuffled{kQuad[2], kQuad[0], kQuad[3], kQuad[1]};
  ASSERT_TRUE(code_quad(shuffled, other));
  EXPECT_EQ(code.code, other.code);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(shuffled[other.order[k]], kQuad[code.order[k]]);
}

TEST(CodeQuad, ChangesWhenThePointsAreMirrored) {
  QuadCode code, mirrored;
  ASSERT_TRUE(code_quad(kQuad, code));
  Points points = kQuad;
  for (Eigen::Vector2d& p : points) p.x() = -p.x();
  ASSERT_TRUE(code_quad(points, mirrored));
  float apart = 0.0F;
  for (std::size_t k = 0; k < 4; ++k)
    apart = std::max(apart, std::abs(code.code[k] - mirrored.code[k]));
  EXPECT_GT(apart, 0.2F);
}

TEST(CodeQuad, RefusesCrampedAndCoincidingPoints) {
  QuadCode code;
  EXPECT_FALSE(code_quad({Eigen::Vector2d(0, 0), {10, 0}, {3, 0.1}, {6, 0.1}}, code)) << "on AB";
  EXPECT_FALSE(code_quad({Eigen::Vector2d(0, 0), {10, 0}, {5, 3}, {5.1, 3}}, code)) << "C is D";
  const Eigen::Vector2d at(1, 1);
  EXPECT_FALSE(code_quad({at, at, at, at}, code));
}

}  // namespace
}  // namespace landmarkdb
