#include "engine/mono/stretched_rival.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/engine/mono/body_view.hpp"
#include "tests/unit/engine/mono/box_model.hpp"

namespace landmarkdb {
namespace {

using testing::look;
using testing::plain_box;
using testing::View;

TEST(StretchedRival, SpeaksForABodyOfTheModelsProportions) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08);
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const View view = look(model, model, 0.3, seed);
    const Stretch stretch =
        stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
    EXPECT_GT(stretch.log10_odds, 0.5) << seed;
    EXPECT_LT(stretch.log_ratios.norm(), 0.1) << seed;
  }
}

TEST(StretchedRival, MeasuresOtherProportionsAndSpeaksAgainstThem) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08), other = plain_box(0.10, 0.13, 0.092);
  const View view = look(model, other, 0.0, 1);
  ASSERT_GE(view.points.size(), 7U);
  const Stretch stretch =
      stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
  EXPECT_LT(stretch.log10_odds, -1.0);
  // Which axis is which is the solver's choice: the longest change is that of z, the mean is taken
  // off.
  EXPECT_NEAR(stretch.log_ratios.cwiseAbs().maxCoeff(), 2.0 / 3.0 * std::log(0.092 / 0.08), 0.01);
  EXPECT_NEAR(stretch.log_ratios.sum(), 0.0, 1e-9);
}

TEST(StretchedRival, DoesNotSayWhatTheViewDoesNotShow) {
  const SearchModel model = plain_box(0.10, 0.13, 0.08);
  View view = look(model, model, 0.0, 1);
  view.points.resize(4);  // fix the pose and two numbers: proportions fit whatever they are
  const Stretch few = stretched_rival(model, testing::bent_camera(), view.pose, view.points, {});
  EXPECT_LT(std::abs(few.log10_odds), 4.0);
  EXPECT_EQ(stretched_rival(model, testing::bent_camera(), view.pose, {}, {}).log10_odds, 0.0);
}

TEST(StretchAxes, AreTheEdgesOfABox) {
  const Eigen::Matrix3d axes = stretch_axes(plain_box(0.10, 0.13, 0.08));
  EXPECT_TRUE((axes.transpose() * axes).isApprox(Eigen::Matrix3d::Identity(), 1e-12));
  for (Eigen::Index k = 0; k < 3; ++k) EXPECT_NEAR(axes.col(k).cwiseAbs().maxCoeff(), 1.0, 1e-9);
}

}  // namespace
}  // namespace landmarkdb
