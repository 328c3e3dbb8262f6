#include "engine/retrieval/object_evidence.hpp"

#include <memory>

#include <gtest/gtest.h>

#include "engine/base/random.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"

namespace landmarkdb {
namespace {

using testing::Surface;

constexpr double kSpacing_m = 0.01;

// A closed box from `low`, normals outwards.
Surface box(const Eigen::Vector3d& low, const Eigen::Vector3d& size) {
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  Random random(3);
  Surface surface;
  surface.add(low, y, x, kSpacing_m, random);
  surface.add(low + z, x, y, kSpacing_m, random);
  surface.add(low, x, z, kSpacing_m, random);
  surface.add(low + y, z, x, kSpacing_m, random);
  surface.add(low, z, y, kSpacing_m, random);
  surface.add(low + x, y, z, kSpacing_m, random);
  return surface;
}

Entry object_of(const Surface& surface) {
  auto record = std::make_shared<SceneRecord>();
  record->kind = EntryKind::kObject;
  record->prepared.points = surface.points;
  record->prepared.normals = surface.normals;
  record->prepared.resolution_m = kSpacing_m;
  CatalogEntry stored;
  stored.record = std::move(record);
  return make_entry(std::move(stored));
}

double outgrown_in(const Surface& object, const Surface& query) {
  const Entry entry = object_of(object);
  const SurfaceGrid target(query.points, query.normals, kSpacing_m, 2);
  const Meeting meeting{target, object.points, object.normals, true};
  return outgrown_share(meeting, entry, Eigen::Isometry3d::Identity());
}

TEST(OutgrownShare, TellsABoxFromALargerOneThatItFitsInto) {
  const Surface small = box({0, 0, 1}, {0.2, 0.2, 0.2});
  EXPECT_LT(outgrown_in(small, small), 0.02);
  EXPECT_GT(outgrown_in(small, box({0, 0, 1}, {0.4, 0.2, 0.2})), 0.1);
}

TEST(OutgrownShare, DoesNotHoldAnOpenSurfaceToWhereItsScanEnded) {
  Random random(5);
  Surface wall;
  wall.add({0, 0, 1}, {0, 0.2, 0}, {0.2, 0, 0}, kSpacing_m, random);
  Surface larger;
  larger.add({0, 0, 1}, {0, 0.4, 0}, {0.4, 0, 0}, kSpacing_m, random);
  EXPECT_EQ(outgrown_in(wall, larger), 0.0);
}

// What a sensor at zero measured, and the object at the same place.
struct Looked {
  Entry entry;
  CleanQuery query;
  SurfaceGrid target;
};

Looked looked(const Surface& object, const Surface& measured) {
  PointCloud cloud;
  cloud.points = measured.points;
  cloud.viewpoints = {Eigen::Vector3f::Zero()};
  return {object_of(object),
          clean_query(cloud),
          SurfaceGrid(measured.points, measured.normals, kSpacing_m, 2)};
}

Evidence evidence_of(const Looked& looked, const Eigen::Isometry3d& T_entry_sensor) {
  const PreparedCloud& cloud = looked.entry.record().prepared;
  const Meeting meeting{looked.target, cloud.points, cloud.normals, true};
  Assessed assessed;
  assessed.T_entry_sensor = T_entry_sensor;
  assessed.icp.T_target_source = T_entry_sensor.inverse();
  look_at_object(meeting, looked.entry, looked.query, cloud.size(), assessed);
  return assessed.evidence;
}

Surface plate(double half_m, double depth_m) {
  Random random(7);
  Surface surface;
  surface.add(
      {-half_m, -half_m, depth_m}, {0, 2 * half_m, 0}, {2 * half_m, 0, 0}, kSpacing_m, random);
  return surface;
}

TEST(LookAtObject, ExpectsNothingOfWhatTheObjectItselfHides) {
  const Surface front = plate(0.2, 1.0);
  Surface both = front;
  const Surface behind = plate(0.1, 1.1);
  both.points.insert(both.points.end(), behind.points.begin(), behind.points.end());
  both.normals.insert(both.normals.end(), behind.normals.begin(), behind.normals.end());
  // Another stands far behind the rest, so that what was measured hides nothing.
  const Evidence evidence =
      evidence_of(looked(both, plate(1.0, 3.0)), Eigen::Isometry3d::Identity());
  EXPECT_NEAR(evidence.seen_points, static_cast<double>(front.points.size()), 20.0);
}

TEST(LookAtObject, FindsASurfaceHalfACellOffLessClose) {
  const Surface surface = plate(0.2, 1.0);
  const Looked at = looked(surface, surface);
  const Evidence on = evidence_of(at, Eigen::Isometry3d::Identity());
  const Evidence off =
      evidence_of(at, Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.5 * kSpacing_m)));
  EXPECT_GT(on.closeness, 0.95);
  EXPECT_LT(off.closeness, 0.4);
  EXPECT_GT(off.overlap, 0.95) << "which is near enough for the overlap";
  EXPECT_LT(on.structure, 0.01) << "all its normals are one";
}

}  // namespace
}  // namespace landmarkdb
