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

}  // namespace
}  // namespace landmarkdb
