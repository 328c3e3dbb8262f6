#include "engine/registration/range_image.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

constexpr double kStep = std::numbers::pi / 180.0;
constexpr float kPatch_m = 0.05F;
constexpr SightTolerance kTolerance{0.1F, 0.02F};
using Points = std::vector<Eigen::Vector3f>;

// A depth camera's view of the plane z = depth_m: x, y within half of it, a ray every 0.3 deg.
Points wall(float depth_m) {
  Points points;
  for (int i = -100; i <= 100; ++i) {
    for (int j = -100; j <= 100; ++j) {
      points.emplace_back(0.005F * static_cast<float>(i) * depth_m,
                          0.005F * static_cast<float>(j) * depth_m,
                          depth_m);
    }
  }
  return points;
}

// A patch of the plane z = depth_m, points every 3 cm, as an entry has them.
Points patch(const Eigen::Vector2f& low, const Eigen::Vector2f& high, float depth_m) {
  Points points;
  for (float x = low.x(); x <= high.x(); x += 0.03F) {
    for (float y = low.y(); y <= high.y(); y += 0.03F) points.emplace_back(x, y, depth_m);
  }
  return points;
}

SightCounts compare(const RangeImage& image,
                    const Points& surface,
                    const Eigen::Isometry3d& T = Eigen::Isometry3d::Identity()) {
  return image.compare({surface}, T, kPatch_m, kTolerance);
}

TEST(RangeImage, AgreesWithTheSurfaceThatWasMeasured) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  EXPECT_NEAR(image.max_range_m(), std::sqrt(2.0 * 2.0 + 1.0 + 1.0), 1e-5);
  EXPECT_EQ(image.step_rad(), kStep);
  const SightCounts counts = compare(image, patch({-1, -1}, {1, 1}, 2.0F));
  EXPECT_GT(counts.measured, 1500U);  // 53 deg by 53 deg
  EXPECT_GT(static_cast<double>(counts.agree), 0.99 * static_cast<double>(counts.measured));
  EXPECT_EQ(counts.crossed, 0U);
  EXPECT_EQ(counts.hidden, 0U);
}

TEST(RangeImage, SeesAPatchWhoseCentreLiesOutsideTheView) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  // 26.6 deg to the view's edge; the patch spans 5 deg to each side of 30 deg.
  const float angle = 30.0F * std::numbers::pi_v<float> / 180.0F;
  const Points beside{{0.5F * std::sin(angle), 0.0F, 0.5F * std::cos(angle)}};
  const SightCounts counts =
      image.compare({beside}, Eigen::Isometry3d::Identity(), 0.087F, kTolerance);
  EXPECT_GT(counts.crossed, 0U);
}

TEST(RangeImage, IsMovedByNothingBehindTheSensor) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  Points surface = patch({-1, -1}, {1, 1}, 2.0F);
  const SightCounts before = compare(image, surface);
  const Points behind = patch({-1, -1}, {1, 1}, -0.5F);
  surface.insert(surface.end(), behind.begin(), behind.end());
  const SightCounts after = compare(image, surface);
  EXPECT_EQ(after.agree, before.agree);
  EXPECT_EQ(after.crossed, 0U);
  EXPECT_EQ(after.predicted(), before.predicted());
}

TEST(RangeImage, FillsTheGapsBetweenAnEntrysPointsAndNothingBeyondThem) {
  constexpr float kDepth = 3.2F;
  const RangeImage image(wall(kDepth), Eigen::Vector3f::Zero(), kStep);
  // Points some 6 cm apart, where a cell is 5.6 cm wide: some cells have none.
  Random random(3);
  Points uneven;
  for (double x = -1.0; x <= 1.0; x += 0.06) {
    for (double y = -1.0; y <= 1.0; y += 0.06) {
      uneven.emplace_back(static_cast<float>(x + random.uniform(-0.015, 0.015)),
                          static_cast<float>(y + random.uniform(-0.015, 0.015)),
                          kDepth);
    }
  }
  const SightCounts counts = compare(image, uneven);
  const double cells = std::pow(2.0 * std::atan(1.0 / static_cast<double>(kDepth)) / kStep, 2.0);
  EXPECT_GT(static_cast<double>(counts.agree), 0.98 * cells);
  EXPECT_LT(static_cast<double>(counts.agree), 1.1 * cells);
  EXPECT_EQ(counts.agree, counts.predicted());
}

TEST(RangeImage, SeesThatARayWentThroughASurfaceBeforeTheWall) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const SightCounts counts = compare(image, patch({-0.3F, -0.3F}, {0.3F, 0.3F}, 1.0F));
  EXPECT_GT(counts.crossed, 800U);
  EXPECT_EQ(counts.agree, 0U);
  EXPECT_EQ(counts.hidden, 0U);
  EXPECT_EQ(counts.predicted(), counts.crossed);
}

TEST(RangeImage, TakesWhatLiesBehindTheWallForHidden) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const SightCounts counts = compare(image, patch({-1, -1}, {1, 1}, 4.0F));
  EXPECT_GT(counts.hidden, 500U);
  EXPECT_EQ(counts.crossed, 0U);
  EXPECT_EQ(counts.agree, 0U);
}

TEST(RangeImage, TellsAnOutlineOfItsOwnFromOneWithinALargerSurface) {
  const Points surface = patch({-0.3F, -0.3F}, {0.3F, 0.3F}, 2.0F);
  const auto continued = [&](const Points& measured) {
    const RangeImage image(measured, Eigen::Vector3f::Zero(), kStep);
    const OutlineCounts counts =
        image.outline({surface}, Eigen::Isometry3d::Identity(), kPatch_m, kTolerance);
    EXPECT_GT(counts.measured, 40U);
    return static_cast<double>(counts.continued) / static_cast<double>(counts.measured);
  };
  EXPECT_EQ(continued(wall(2.0F)), 1.0);
  Points before_a_wall;
  for (const Eigen::Vector3f& p : wall(2.0F)) {
    const bool on = p.head<2>().cwiseAbs().maxCoeff() <= 0.3F;
    before_a_wall.push_back(on ? p : Eigen::Vector3f(1.5F * p));
  }
  EXPECT_LT(continued(before_a_wall), 0.05);
}

TEST(RangeImage, LetsTheNearerOfTwoSurfacesDecide) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  Points both = patch({-2, -2}, {2, 2}, 4.0F);
  const Points front = patch({-1.2F, -1.2F}, {1.2F, 1.2F}, 2.0F);
  both.insert(both.begin(), front.begin(), front.end());
  const SightCounts counts = compare(image, both);
  EXPECT_EQ(counts.hidden, 0U);
  EXPECT_GT(counts.agree, 1500U);
}

TEST(RangeImage, SaysNothingWhereTheEntryHasNothing) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  EXPECT_EQ(compare(image, {}).predicted(), 0U);
  EXPECT_GT(compare(image, {}).measured, 0U);
  // Beside and behind the camera nothing was measured.
  EXPECT_EQ(compare(image, patch({-1, -1}, {1, 1}, -2.0F)).predicted(), 0U);
  Points beside;
  for (const Eigen::Vector3f& p : patch({-1, -1}, {1, 1}, 2.0F))
    beside.emplace_back(p.z(), p.y(), p.x());
  for (Eigen::Vector3f& p : beside) p.z() = std::min(p.z(), 0.5F);
  EXPECT_EQ(compare(image, beside).predicted(), 0U);
}

TEST(RangeImage, GivesTheRangeItsSlack) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  // 0.1 m and 2 % of the range: 0.14 m and more.
  EXPECT_EQ(compare(image, patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 1.88F)).crossed, 0U);
  EXPECT_EQ(compare(image, patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 2.12F)).hidden, 0U);
  EXPECT_GT(compare(image, patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 1.75F)).crossed, 100U);
  EXPECT_GT(compare(image, patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 2.3F)).hidden, 100U);
}

TEST(RangeImage, TakesLessSlackForWhatContradictsInAnArea) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const Points nearer = patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 1.9F);  // within 0.14 m, not 0.07 m
  SightTolerance tolerance = kTolerance;
  const auto compared = [&] {
    return image.compare({nearer}, Eigen::Isometry3d::Identity(), kPatch_m, tolerance);
  };
  EXPECT_EQ(compared().solid, 0U);
  tolerance.solid = 0.5F;
  const SightCounts counts = compared();
  EXPECT_EQ(counts.crossed, 0U);
  EXPECT_GT(counts.agree, 100U);
  EXPECT_EQ(counts.solid, counts.agree);
  EXPECT_EQ(counts.solid_crossed, counts.agree);
}

TEST(RangeImage, TakesNoBackForAContradictionByPartOfTheSlack) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const Points nearer = patch({-0.6F, -0.6F}, {0.6F, 0.6F}, 1.9F);
  const Points away(nearer.size(), Eigen::Vector3f::UnitZ());  // seen from behind
  SightTolerance tolerance = kTolerance;
  tolerance.solid = 0.5F;
  const SightCounts counts =
      image.compare({nearer, away, 0.0}, Eigen::Isometry3d::Identity(), kPatch_m, tolerance);
  EXPECT_EQ(counts.predicted(), 0U);
  EXPECT_EQ(counts.solid, 0U);
}

TEST(RangeImage, LetsSilhouettesDecideNothing) {
  // A post before a wall. The entry has both, half a cell aside: its edges must not count as
  // crossed or hidden.
  Points seen;
  for (const Eigen::Vector3f& p : wall(4.0F)) {
    const bool post = std::abs(p.x() / p.z()) < 0.1F;
    seen.push_back(post ? Eigen::Vector3f(0.5F * p) : p);
  }
  Points entry = patch({-1.9F, -1.9F}, {1.9F, 1.9F}, 4.0F);
  const Points post = patch({-0.2F, -1.0F}, {0.2F, 1.0F}, 2.0F);
  entry.insert(entry.end(), post.begin(), post.end());
  const RangeImage image(seen, Eigen::Vector3f::Zero(), kStep);
  Eigen::Isometry3d aside = Eigen::Isometry3d::Identity();
  aside.linear() = rotation_from_vector({0, 0.5 * kStep, 0});
  const SightCounts counts = compare(image, entry, aside);
  EXPECT_GT(counts.agree, 1000U);
  EXPECT_LT(static_cast<double>(counts.crossed + counts.hidden),
            0.01 * static_cast<double>(counts.predicted()));
}

TEST(RangeImage, CarriesTheEntryIntoItsOwnFrame) {
  Random random(1);
  Eigen::Isometry3d T_here_entry = Eigen::Isometry3d::Identity();
  T_here_entry.linear() = rotation_from_vector({0.4, -1.0, 2.0});
  T_here_entry.translation() = Eigen::Vector3d(10, -20, 5);
  Points entry;
  for (const Eigen::Vector3f& p : patch({-1, -1}, {1, 1}, 2.0F)) {
    entry.emplace_back((T_here_entry.inverse() * p.cast<double>()).cast<float>());
  }
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const SightCounts counts = compare(image, entry, T_here_entry);
  EXPECT_GT(static_cast<double>(counts.agree), 0.99 * static_cast<double>(counts.measured));
}

TEST(RangeImage, LooksFromTheViewpointItIsGiven) {
  const Eigen::Vector3f viewpoint(5, -3, 1);
  Points seen = wall(2.0F);
  Points entry = patch({-0.3F, -0.3F}, {0.3F, 0.3F}, 1.0F);
  for (Eigen::Vector3f& p : seen) p += viewpoint;
  for (Eigen::Vector3f& p : entry) p += viewpoint;
  const RangeImage image(seen, viewpoint, kStep);
  EXPECT_GT(compare(image, entry).crossed, 800U);
}

// A sphere of 5 m around the sensor, `columns` points in each of `rings` between two elevations.
Points ball(int rings, int columns, double lowest, double highest) {
  Points points;
  for (int i = 0; i < rings; ++i) {
    const double elevation = rings == 1 ? lowest : lowest + (highest - lowest) * i / (rings - 1);
    for (int j = 0; j < columns; ++j) {
      const double azimuth = 2.0 * std::numbers::pi * j / columns;
      points.push_back(5.0F * Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                                              std::cos(elevation) * std::sin(azimuth),
                                              std::sin(elevation))
                                  .cast<float>());
    }
  }
  return points;
}

TEST(RangeImage, SeesAllRoundWithoutAPole) {
  const Points all_round = ball(361, 720, -0.5 * std::numbers::pi, 0.5 * std::numbers::pi);
  const RangeImage image(all_round, Eigen::Vector3f::Zero(), 2.0 * kStep);
  EXPECT_EQ(image.step_rad(), 2.0 * kStep);
  const SightCounts counts = compare(image, all_round);
  EXPECT_EQ(counts.measured, 6U * 45U * 45U) << "every direction of every face";
  EXPECT_EQ(counts.agree, counts.measured);
  // A bubble inside is crossed wherever it is, also where faces meet and straight up.
  for (const Eigen::Vector3f& direction : {Eigen::Vector3f(1, 1, 1),
                                           Eigen::Vector3f(0, 0, 1),
                                           Eigen::Vector3f(-1, -1, 0),
                                           Eigen::Vector3f(0.2F, -1, -1)}) {
    Points bubble;
    for (const Eigen::Vector3f& p : ball(61, 120, -1.5, 1.5)) {
      bubble.push_back(0.1F * p + 2.5F * direction.normalized());
    }
    const SightCounts inside = compare(image, bubble);
    EXPECT_GT(inside.crossed, 50U);
    EXPECT_EQ(inside.agree + inside.hidden, 0U);
  }
}

TEST(RangeImage, WidensItsCellsForSparseRings) {
  // Sixteen lines two degrees apart: with cells of one degree every other row would be empty.
  const Points lidar = ball(16, 1800, -0.2618, 0.2618);
  const RangeImage image(lidar, Eigen::Vector3f::Zero(), kStep);
  EXPECT_GT(image.step_rad(), kStep);
  EXPECT_LT(image.step_rad(), 0.15);
  const Points around = ball(121, 720, -0.6, 0.6);
  const SightCounts counts = compare(image, around);
  EXPECT_GT(counts.measured, 100U);
  EXPECT_EQ(counts.crossed, 0U);
  EXPECT_EQ(counts.agree, counts.measured);
  Points nearer = around;
  for (Eigen::Vector3f& p : nearer) p *= 0.5F;
  EXPECT_EQ(compare(image, nearer).crossed, counts.measured);
}

TEST(RangeImage, KeepsItsCellsFineWhereAViewIsInShreds) {
  // Strips of three degrees and a bit, a degree apart: of each the middle is whole, less than half
  // of what was measured.
  Points strips;
  for (const Eigen::Vector3f& p : wall(2.0F)) {
    const double degrees = std::atan2(p.x(), p.z()) / kStep;
    if (std::fmod(degrees + 90.0, 5.0) < 3.3) strips.push_back(p);
  }
  const RangeImage image(strips, Eigen::Vector3f::Zero(), kStep);
  EXPECT_EQ(image.step_rad(), kStep);
  const SightCounts counts = compare(image, patch({-1, -1}, {1, 1}, 2.0F));
  EXPECT_GT(counts.measured, 300U);
  EXPECT_LT(counts.measured, 1500U);
  EXPECT_EQ(counts.agree, counts.predicted());
}

TEST(RangeImage, HidesWhatLiesBehindWhatWasMeasured) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  constexpr float kSlack_m = 0.1F;
  EXPECT_TRUE(image.hides({0.3F, 0.2F, 3.0F}, kSlack_m));
  EXPECT_FALSE(image.hides({0.3F, 0.2F, 2.05F}, kSlack_m)) << "on the wall, within the slack";
  EXPECT_FALSE(image.hides({0.3F, 0.2F, 1.0F}, kSlack_m)) << "before it";
  EXPECT_FALSE(image.hides({3.0F, 0.0F, 3.0F}, kSlack_m)) << "beside the view";
  EXPECT_FALSE(image.hides({0.0F, 0.0F, -3.0F}, kSlack_m)) << "behind the sensor";
  EXPECT_FALSE(image.hides(Eigen::Vector3f::Zero(), kSlack_m));
}

TEST(RangeImage, LookedThroughWhatLiesBeforeWhatWasMeasured) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  constexpr float kSlack_m = 0.1F;
  EXPECT_TRUE(image.looked_through({0.2F, 0.1F, 1.0F}, kSlack_m));
  EXPECT_FALSE(image.looked_through({0.3F, 0.2F, 1.95F}, kSlack_m)) << "within the slack";
  EXPECT_FALSE(image.looked_through({0.3F, 0.2F, 3.0F}, kSlack_m)) << "behind the wall";
  EXPECT_FALSE(image.looked_through({1.0F, 0.0F, 1.0F}, kSlack_m)) << "beside the view";
  EXPECT_FALSE(image.looked_through({0.0F, 0.0F, -1.0F}, kSlack_m)) << "behind the sensor";
  EXPECT_FALSE(image.looked_through(Eigen::Vector3f::Zero(), kSlack_m));
}

// Cells are three patches wide from 8.6 m on: of a wall beyond, a part of the points will do.
TEST(RangeImage, SeesAFarSurfaceWholeInPartOfItsPoints) {
  constexpr float kDepth_m = 12.0F;
  const RangeImage image(wall(kDepth_m), Eigen::Vector3f::Zero(), kStep);
  Points points;
  for (float x = -6.0F; x <= 6.0F; x += kPatch_m) {
    for (float y = -6.0F; y <= 6.0F; y += kPatch_m) points.emplace_back(x, y, kDepth_m);
  }
  const SightSurface surface(points, {}, kPatch_m);
  std::size_t in_part = 0;
  for (const SightSurface::Block& block : surface.blocks()) {
    in_part += block.spread_end - block.begin;
  }
  EXPECT_LT(in_part, points.size() / 2);
  const SightCounts counts =
      image.compare(surface, Eigen::Isometry3d::Identity(), kPatch_m, kTolerance);
  EXPECT_GT(static_cast<double>(counts.agree), 0.98 * static_cast<double>(counts.measured));
  EXPECT_EQ(counts.crossed + counts.hidden, 0U);
}

TEST(RangeImage, HoldsAgainstCloudsThatHoldNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Points& points :
       {Points{}, Points{{0, 0, 0}}, Points{{nan, 1, 1}}, Points{{0, 0, 1}}}) {
    const RangeImage image(points, Eigen::Vector3f::Zero(), kStep);
    EXPECT_EQ(compare(image, patch({-1, -1}, {1, 1}, 2.0F)).predicted(), 0U);
  }
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  EXPECT_EQ(compare(image, {{nan, 0, 2}, {0, 0, 0}}).predicted(), 0U);
}

// A camera before the wall at 2 m, and a screen at 1 m that it did not see.
TEST(RangeImage, TellsAThingThatIsNotThereFromASilhouette) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  Points screen = patch({-1, -1}, {1, 1}, 2.0F);
  const Points near = patch({-0.2F, -0.2F}, {0.2F, 0.2F}, 1.0F);
  screen.insert(screen.end(), near.begin(), near.end());
  const SightCounts area = compare(image, screen);
  EXPECT_GT(area.crossed, 200U);            // 23 by 23 deg
  EXPECT_GT(2 * area.solid, area.crossed);  // but its rim
  EXPECT_LT(area.solid, area.crossed);
  EXPECT_EQ(area.solid_crossed, area.solid);
  Points rod = patch({-1, -1}, {1, 1}, 2.0F);
  for (float y = -0.5F; y <= 0.5F; y += 0.01F) rod.emplace_back(0.0F, y, 1.8F);
  constexpr float kThin_m = 0.02F;  // less than a cell at that range
  const SightCounts line = image.compare({rod}, Eigen::Isometry3d::Identity(), kThin_m, kTolerance);
  EXPECT_GT(line.crossed, 20U);
  EXPECT_EQ(line.solid, 0U);
}

// A wall before half of what should be seen at 3 m: none of that was seen through.
TEST(RangeImage, TellsWhatIsHiddenFromWhatIsCrossed) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const SightCounts counts = compare(image, patch({-0.5F, -0.5F}, {0.5F, 0.5F}, 3.0F));
  EXPECT_GT(counts.hidden, 200U);
  EXPECT_EQ(counts.crossed, 0U);
  EXPECT_EQ(counts.solid, counts.hidden);
  EXPECT_EQ(counts.solid_crossed, 0U);
}

// Two things in two corners of the view, on different faces of the cube: each is compared.
TEST(RangeImage, ComparesAllThatStandsApart) {
  Points around = patch({-4, -4}, {4, 4}, 2.0F);
  for (const Eigen::Vector3f& p : patch({-4, -4}, {4, 4}, 2.0F)) {
    around.emplace_back(p.z(), p.x(), p.y());
  }
  const RangeImage image(around, Eigen::Vector3f::Zero(), kStep);
  const Points ahead = patch({0.5F, 0.3F}, {0.9F, 0.8F}, 2.0F);
  Points aside;
  for (const Eigen::Vector3f& p : ahead) aside.emplace_back(p.z(), p.x(), p.y());
  Points both = ahead;
  both.insert(both.end(), aside.begin(), aside.end());
  const SightCounts first = compare(image, ahead);
  const SightCounts second = compare(image, aside);
  EXPECT_GT(first.agree, 50U);
  EXPECT_GT(second.agree, 50U);
  EXPECT_EQ(compare(image, both).agree, first.agree + second.agree);
}

TEST(RangeImage, SaysNothingOfTheBackOfASurface) {
  const RangeImage image(wall(2.0F), Eigen::Vector3f::Zero(), kStep);
  const Points behind = patch({-1, -1}, {1, 1}, 2.6F);
  const Points facing(behind.size(), Eigen::Vector3f(0, 0, -1));
  const Points away(behind.size(), Eigen::Vector3f(0, 0, 1));
  const Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  EXPECT_GT(image.compare({behind, facing}, T, kPatch_m, kTolerance).hidden, 500U);
  EXPECT_EQ(image.compare({behind, away}, T, kPatch_m, kTolerance).predicted(), 0U);
  // One that stands in the way was looked through, whichever side it shows.
  const Points before = patch({-1, -1}, {1, 1}, 1.0F);
  EXPECT_GT(image.compare({before, away}, T, kPatch_m, kTolerance).crossed, 500U);
}

}  // namespace
}  // namespace landmarkdb
