#include "datasets/objects/object_model.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace landmarkdb::datasets {
namespace {

TEST(MakeObject, StandsOnItsFootAndIsTheSameForTheSameSeed) {
  for (const auto kinds : {table_objects(), floor_objects()}) {
    for (const ObjectKind kind : kinds) {
      const ObjectModel model = make_object({.kind = kind, .seed = 5});
      Eigen::AlignedBox3f box;
      for (const Eigen::Vector3f& p : model.mesh.vertices) box.extend(p);
      EXPECT_NEAR(box.min().z(), 0.0F, 1e-5F) << model.name;
      EXPECT_NEAR(box.center().x(), 0.0F, 1e-4F) << model.name;
      EXPECT_GT(model.extent_m, 0.05) << model.name;
      EXPECT_LT(model.extent_m, 3.0) << model.name;
      const ObjectModel again = make_object({.kind = kind, .seed = 5});
      EXPECT_EQ(again.mesh.vertices, model.mesh.vertices) << model.name;
      const ObjectModel twin = make_object({.kind = kind, .seed = 5, .twin = 1});
      ASSERT_EQ(twin.mesh.vertices.size(), model.mesh.vertices.size());
      EXPECT_GT(std::abs(twin.extent_m / model.extent_m - 1.0), 0.005) << model.name;
    }
  }
}

TEST(ObjectError, KnowsWhatASymmetryLeavesTheSame) {
  const ObjectModel carton = make_object({.kind = ObjectKind::kCarton, .seed = 3});
  ASSERT_EQ(carton.symmetries.size(), 3U);
  Eigen::Isometry3d truth = Eigen::Isometry3d::Identity();
  truth.translation() = Eigen::Vector3d(1.0, 2.0, 0.5);
  const ObjectError turned = object_error(carton, truth, truth * carton.symmetries[2]);
  EXPECT_NEAR(turned.degrees, 180.0, 1e-6);
  EXPECT_NEAR(turned.symmetric_degrees, 0.0, 1e-5);
  EXPECT_NEAR(turned.symmetric_metres, 0.0, 1e-9);

  const ObjectModel bottle = make_object({.kind = ObjectKind::kBottle, .seed = 3});
  ASSERT_TRUE(bottle.revolution);
  const Eigen::Isometry3d about(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()));
  EXPECT_NEAR(object_error(bottle, truth, truth * about).degrees, 0.0, 1e-5);
  const Eigen::Isometry3d tilted(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
  EXPECT_NEAR(
      object_error(bottle, truth, truth * tilted).degrees, 0.1 * 180.0 / std::numbers::pi, 1e-5);
}

TEST(ScanObject, SeesItFromAllSidesAndOnlyItsFrontWhereAsked) {
  const ObjectModel model = make_object({.kind = ObjectKind::kFigurine, .seed = 2});
  ObjectScanOptions options;
  options.spacing_m = 0.01;
  options.noise_m = 0.0;
  const PointCloud around = scan_object(model, options, {});
  EXPECT_GT(around.viewpoints.size(), 10U);
  EXPECT_EQ(around.viewpoint_index.size(), around.size());
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : model.mesh.vertices) box.extend(p);
  for (const Eigen::Vector3f& p : around.points) EXPECT_LT(box.exteriorDistance(p), 1e-4F);
  options.views = ObjectViews::kFront;
  options.keep_viewpoints = false;
  const PointCloud front = scan_object(model, options, {});
  EXPECT_LT(front.size(), around.size());
  EXPECT_TRUE(front.viewpoints.empty());
  RunContext two;
  two.threads = 2;
  EXPECT_EQ(scan_object(model, options, two).points, front.points);
}

}  // namespace
}  // namespace landmarkdb::datasets
