#include "engine/retrieval/feature_options.hpp"

#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

constexpr auto kStructure = KeypointMethod::kStructure;

FeatureOptions of_place(double extent_m, double spacing_m) {
  return derive_feature_options({extent_m, spacing_m}, EntryKind::kPlace, kStructure);
}

FeatureOptions of_object(double extent_m, double spacing_m) {
  return derive_feature_options({extent_m, spacing_m}, EntryKind::kObject, kStructure);
}

TEST(DeriveFeatureOptions, StandsOnALadderOfStepsOfRootTwo) {
  std::set<double> voxels;
  for (double extent_m = 0.5; extent_m < 500.0; extent_m *= 1.03) {
    for (const double spacing_m : {0.001, 0.01, 0.1, 0.9}) {
      const double voxel_m = of_place(extent_m, spacing_m * extent_m / 100.0).voxel_m;
      const double step = 2.0 * std::log2(voxel_m / 0.05);
      EXPECT_NEAR(step, std::round(step), 1e-9) << extent_m;
      voxels.insert(voxel_m);
    }
  }
  EXPECT_LE(voxels.size(), 18U) << "places of like size must share a resolution, bit for bit";
  EXPECT_GE(voxels.size(), 6U);
}

TEST(DeriveFeatureOptions, GrowsWithExtentAndSpacing) {
  double before = 0.0;
  for (double extent_m = 0.5; extent_m < 2000.0; extent_m *= 1.3) {
    const double voxel_m = of_place(extent_m, 0.001).voxel_m;
    EXPECT_GE(voxel_m, before);
    before = voxel_m;
  }
  EXPECT_NEAR(of_place(25.0, 0.001).voxel_m, 0.05, 1e-12);  // a room of 25 m at 5 cm
  EXPECT_GT(of_place(25.0, 0.3).voxel_m, 0.2) << "finer than the scan there is nothing";
  EXPECT_GE(of_place(0.6, 1e-4).voxel_m, 0.024) << "a place is seen by a sensor of centimetres";
}

TEST(DeriveFeatureOptions, HangsAllLengthsOnTheVoxel) {
  const FeatureOptions a = of_place(9.0, 0.01);
  const FeatureOptions b = of_place(9.0, 0.2);
  const double ratio = b.voxel_m / a.voxel_m;
  EXPECT_GT(ratio, 2.0);
  EXPECT_NEAR(b.shot_radius_m / a.shot_radius_m, ratio, 1e-9);
  EXPECT_NEAR(b.normal_radius_m / a.normal_radius_m, ratio, 1e-9);
  EXPECT_NEAR(b.keypoint_spacing_m / a.keypoint_spacing_m, ratio, 1e-9);
  EXPECT_GE(a.shot_radius_m, 10.0 * a.voxel_m);
}

TEST(DeriveFeatureOptions, DescribesAnObjectAlikeWhateverItsSize) {
  // 2^10 lies 20 steps up the ladder: the thing in "millimetres" of 1/1024 m.
  const FeatureOptions metres = of_object(0.3, 0.001);
  const FeatureOptions tiny = of_object(0.3 / 1024.0, 0.001 / 1024.0);
  EXPECT_NEAR(metres.voxel_m / tiny.voxel_m, 1024.0, 1e-6);
  EXPECT_NEAR(metres.shot_radius_m / tiny.shot_radius_m, 1024.0, 1e-6);
  const double across = 0.3 / metres.voxel_m;
  EXPECT_GT(across, 40.0);
  EXPECT_LT(across, 90.0);
}

TEST(DeriveFeatureOptions, TakesWhatIsGivenAndDerivesTheRest) {
  const FeatureOptions voxel = derive_feature_options(
      {10.0, 0.01}, EntryKind::kPlace, KeypointMethod::kIss, 0.123, std::nullopt);
  EXPECT_EQ(voxel.voxel_m, 0.123);
  EXPECT_NEAR(voxel.shot_radius_m, 12.0 * 0.123, 1e-12);
  EXPECT_EQ(voxel.keypoints, KeypointMethod::kIss);
  const FeatureOptions radius =
      derive_feature_options({10.0, 0.01}, EntryKind::kPlace, kStructure, std::nullopt, 0.8);
  EXPECT_EQ(radius.shot_radius_m, 0.8);
  EXPECT_EQ(radius.voxel_m, of_place(10.0, 0.01).voxel_m);
}

TEST(KeypointOptionsOf, FollowTheEntry) {
  FeatureOptions options = of_place(10.0, 0.01);
  options.keypoints = KeypointMethod::kUniform;
  const KeypointOptions keypoints = keypoint_options(options);
  EXPECT_EQ(keypoints.method, KeypointMethod::kUniform);
  EXPECT_EQ(keypoints.spacing_m, options.keypoint_spacing_m);
  EXPECT_GT(keypoints.structure_radius_m, options.voxel_m);
}

}  // namespace
}  // namespace landmarkdb
