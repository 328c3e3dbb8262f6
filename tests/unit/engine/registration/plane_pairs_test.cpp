#include "engine/registration/plane_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLanes = PointGroups::kLanes;
constexpr std::size_t kPairNumbers = PlaneSummer::kNumbers;

// A corner, points that lie near it under `motion` and a few far from everything.
struct Scene {
  testing::Surface corner = testing::corner_room(0.05);
  std::vector<Eigen::Vector3f> points, normals;
  PointMotion motion;

  explicit Scene(std::size_t count) {
    Random random(3);
    const Eigen::Isometry3d T = testing::random_pose(random, 0.5, 0.3);
    motion = {T.linear().cast<float>(), T.translation().cast<float>()};
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t taken = i * 37 % corner.points.size();
      const float far = i % 11 == 0 ? 300.0F : 0.02F * static_cast<float>(random.normal());
      const Eigen::Vector3f moved = corner.points[taken] + far * corner.normals[taken];
      points.push_back(T.inverse().cast<float>() * moved);
      normals.push_back(T.linear().transpose().cast<float>() * corner.normals[taken]);
    }
  }
  SurfaceGrid grid() const { return {corner.points, corner.normals, 0.1, 2}; }
};

// The same surface a long way off in a second part: too wide for a table of blocks.
SurfaceGrid far_apart(const Scene& scene) {
  std::vector<Eigen::Vector3f> points = scene.corner.points;
  std::vector<Eigen::Vector3f> normals = scene.corner.normals;
  points.emplace_back(50'000, 50'000, 50'000);
  normals.emplace_back(0, 0, 1);
  return {points, normals, 0.1, 2};
}

std::vector<float> paired(const PairKernels& kernels,
                          const SurfaceGrid& grid,
                          const PointGroups& groups,
                          const PointMotion& motion,
                          const PairOptions& options) {
  std::vector<float> values(groups.groups() * kLanes * kPairNumbers);
  kernels.pair(grid, groups.group(0), groups.groups(), motion, options, values.data());
  return values;
}

std::vector<float> fits_of(const PairKernels& kernels,
                           const SurfaceGrid& grid,
                           const PointGroups& groups,
                           const PointMotion& motion) {
  std::vector<float> fits(groups.groups() * kLanes);
  kernels.fits(grid, groups.group(0), groups.groups(), motion, -30.0F, fits.data());
  return fits;
}

TEST(PointGroups, HoldsEachPointOnceAndEndsInPointsWithoutNormal) {
  const Scene scene(50);
  const PointGroups groups(scene.points, scene.normals, 3);
  ASSERT_EQ(groups.size(), 17U);
  ASSERT_EQ(groups.groups(), 2U);
  for (std::size_t i = 0; i < 2 * kLanes; ++i) {
    const float* at = groups.group(i / kLanes) + i % kLanes;
    const bool held = i < groups.size();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<Eigen::Index>(axis);
      EXPECT_EQ(at[axis * kLanes], held ? scene.points[3 * i][k] : 0.0F);
      EXPECT_EQ(at[(axis + 3) * kLanes], held ? scene.normals[3 * i][k] : 0.0F);
    }
  }
  EXPECT_EQ(PointGroups({}, {}).groups(), 0U);
}

void expect_pairs_of_grid(const SurfaceGrid& grid, const Scene& scene, const PairOptions& options) {
  const PointGroups groups(scene.points, scene.normals);
  const std::vector<float> values = paired(pair_kernels(), grid, groups, scene.motion, options);
  std::size_t met = 0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const float* at = values.data() + i / kLanes * kLanes * kPairNumbers + i % kLanes;
    const Eigen::Vector3f p =
        scene.motion.R_target_source * scene.points[i] + scene.motion.t_target_source;
    const Surfel* near = grid.near(p);
    if (near == nullptr) {
      EXPECT_EQ(at[7 * kLanes], 0.0F);
      continue;
    }
    ++met;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<Eigen::Index>(axis);
      EXPECT_EQ(at[axis * kLanes], near->normal[k]);
      EXPECT_NEAR(at[(axis + 3) * kLanes], p[k] - options.centre[k], 1e-3);
    }
    const float cosine = near->normal.dot(scene.motion.R_target_source * scene.normals[i]);
    EXPECT_NEAR(at[6 * kLanes], near->normal.dot(p - near->point), 1e-4);
    EXPECT_NEAR(at[7 * kLanes],
                options.factor == PairFactor::kGraded
                    ? std::max(cosine, 0.0F)
                    : (cosine >= options.min_agreement ? 1.0F : 0.0F),
                1e-5);
  }
  EXPECT_GT(met, scene.points.size() / 2);
  EXPECT_LT(met, scene.points.size());
}

TEST(PairKernels, PairEachPointWithTheSurfelNear) {
  const Scene scene(101);
  for (const PairOptions& options :
       {PairOptions{.factor = PairFactor::kGraded, .centre = {1, 2, 3}},
        PairOptions{.factor = PairFactor::kWhole, .min_agreement = 0.7F}}) {
    expect_pairs_of_grid(scene.grid(), scene, options);
    expect_pairs_of_grid(far_apart(scene), scene, options);
  }
}

// Blocks far above a wide, flat table have numbers that no int holds.
TEST(PairKernels, MeetNothingFarFromAWideFlatTable) {
  const std::vector<Eigen::Vector3f> corners{{0, 0, 0}, {818, 0, 0}, {0, 818, 0}, {818, 818, 0}};
  const std::vector<Eigen::Vector3f> up(4, Eigen::Vector3f::UnitZ());
  const SurfaceGrid grid(corners, up, 0.05, 2);
  const std::vector<Eigen::Vector3f> points{
      {0, 0, 0}, {818, 818, 0}, {1, 1, 1e3F}, {-1e6F, 5e5F, 1e7F}, {818, 818, 2e4F}};
  const std::vector<Eigen::Vector3f> normals(points.size(), Eigen::Vector3f::UnitZ());
  const std::vector<float> fits =
      fits_of(pair_kernels(), grid, PointGroups(points, normals), PointMotion{});
  EXPECT_EQ(fits[0], 1.0F);
  EXPECT_EQ(fits[1], 1.0F);
  for (std::size_t i = 2; i < points.size(); ++i) EXPECT_EQ(fits[i], 0.0F) << i;
}

TEST(PairKernels, MeanFitIsTheMeanOverThePointsOrGivesUp) {
  const Scene scene(70);
  const SurfaceGrid grid = scene.grid();
  const PointGroups groups(scene.points, scene.normals);
  constexpr float kFactor = -0.5F / (0.05F * 0.05F);
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    const Eigen::Vector3f p =
        scene.motion.R_target_source * scene.points[i] + scene.motion.t_target_source;
    const Surfel& near = grid.near_or_none(p);
    const double d = near.normal.dot(p - near.point);
    const double cosine = near.normal.dot(scene.motion.R_target_source * scene.normals[i]);
    sum += std::max(cosine, 0.0) * std::exp(kFactor * d * d);
  }
  const double mean = sum / static_cast<double>(scene.points.size());
  ASSERT_GT(mean, 0.5);
  const auto fit = [&](const FitOptions& options) {
    return pair_kernels().mean_fit(
        grid, groups.group(0), groups.groups(), groups.size(), scene.motion, options);
  };
  EXPECT_NEAR(fit({.factor = kFactor}), mean, 1e-4);
  const float given_up = fit({.factor = kFactor, .first_groups = 2, .hopeless = 0.99F});
  EXPECT_LT(given_up, 0.0F);
  EXPECT_GT(given_up, -1.0F);
}

TEST(PairKernels, FitsAreOfEachPointWhatTheirMeanIsOfAll) {
  const Scene scene(70);
  const SurfaceGrid grid = scene.grid();
  const PointGroups groups(scene.points, scene.normals);
  const std::vector<float> fits = fits_of(pair_kernels(), grid, groups, scene.motion);
  double sum = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    sum += fits[i];
    if (i >= scene.points.size()) {
      EXPECT_EQ(fits[i], 0.0F) << i;
      continue;
    }
    const Eigen::Vector3f p =
        scene.motion.R_target_source * scene.points[i] + scene.motion.t_target_source;
    EXPECT_EQ(fits[i] > 0.0F, grid.near(p) != nullptr) << i;
  }
  const float mean = pair_kernels().mean_fit(
      grid, groups.group(0), groups.groups(), groups.size(), scene.motion, {.factor = -30.0F});
  EXPECT_NEAR(sum / static_cast<double>(groups.size()), mean, 1e-5);
}

TEST(PairKernels, GiveTheSameBytesOnEveryInstructionSet) {
  const PairKernels* baseline = pair_kernels("sse2");
  ASSERT_NE(baseline, nullptr);
  const Scene scene(333);
  const PointGroups groups(scene.points, scene.normals);
  for (const SurfaceGrid& grid : {scene.grid(), far_apart(scene)}) {
    for (const char* name : {"avx2", "avx512"}) {
      const PairKernels* kernels = pair_kernels(name);
      if (kernels == nullptr) continue;
      const std::vector<float> expected = paired(*baseline, grid, groups, scene.motion, {});
      const std::vector<float> values = paired(*kernels, grid, groups, scene.motion, {});
      EXPECT_EQ(std::memcmp(values.data(), expected.data(), values.size() * sizeof(float)), 0)
          << name;
      const auto fit = [&](const PairKernels& of) {
        return of.mean_fit(grid,
                           groups.group(0),
                           groups.groups(),
                           groups.size(),
                           scene.motion,
                           {.factor = -30.0F});
      };
      EXPECT_EQ(fit(*kernels), fit(*baseline)) << name;
      EXPECT_EQ(fits_of(*kernels, grid, groups, scene.motion),
                fits_of(*baseline, grid, groups, scene.motion))
          << name;
    }
  }
  EXPECT_EQ(pair_kernels("none such"), nullptr);
}

}  // namespace
}  // namespace landmarkdb
