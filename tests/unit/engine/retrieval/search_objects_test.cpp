#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/retrieval/localizer.hpp"
#include "tests/support/pose_near.hpp"
#include "tests/unit/engine/registration/surfaces.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using testing::PoseNear;
using testing::Surface;

constexpr double kSpacing_m = 0.004;

// A toy crane of boxes, about 0.4 m, standing on z = 0, without a symmetry: closed, normals
// outwards.
void add_box(Surface& surface,
             const Eigen::Vector3d& low,
             const Eigen::Vector3d& size,
             Random& random) {
  const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
  surface.add(low, y, x, kSpacing_m, random);
  surface.add(low + z, x, y, kSpacing_m, random);
  surface.add(low, x, z, kSpacing_m, random);
  surface.add(low + y, z, x, kSpacing_m, random);
  surface.add(low, z, y, kSpacing_m, random);
  surface.add(low + x, y, z, kSpacing_m, random);
}

Surface crane() {
  Random random(1);
  Surface surface;
  add_box(surface, {-0.12, -0.08, 0.0}, {0.24, 0.16, 0.06}, random);
  add_box(surface, {-0.10, -0.05, 0.06}, {0.09, 0.08, 0.28}, random);
  add_box(surface, {-0.01, -0.04, 0.26}, {0.22, 0.05, 0.05}, random);
  add_box(surface, {0.15, -0.03, 0.16}, {0.03, 0.03, 0.10}, random);
  add_box(surface, {0.02, 0.0, 0.06}, {0.06, 0.06, 0.09}, random);
  return surface;
}

PointCloud cloud_of(const Surface& surface) {
  PointCloud cloud;
  cloud.points = surface.points;
  cloud.normals = surface.normals;
  return cloud;
}

// What a sensor at zero sees of the surfaces: the nearest point in each direction of a fine grid.
PointCloud seen_from_zero(const Surface& surface) {
  constexpr double kStep = 0.004;
  constexpr int kSide = 500;
  std::vector<int> nearest(kSide * kSide, -1);
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f& p = surface.points[i];
    if (p.z() <= 0.1F || surface.normals[i].dot(p) >= 0.0F) continue;
    const int u =
        static_cast<int>(std::floor(static_cast<double>(p.x() / p.z()) / kStep)) + kSide / 2;
    const int v =
        static_cast<int>(std::floor(static_cast<double>(p.y() / p.z()) / kStep)) + kSide / 2;
    if (u < 0 || v < 0 || u >= kSide || v >= kSide) continue;
    int& cell = nearest[static_cast<std::size_t>(v * kSide + u)];
    if (cell < 0 || p.z() < surface.points[static_cast<std::size_t>(cell)].z()) {
      cell = static_cast<int>(i);
    }
  }
  Random random(2);
  PointCloud cloud;
  for (const int i : nearest) {
    if (i < 0) continue;
    const Eigen::Vector3f& p = surface.points[static_cast<std::size_t>(i)];
    cloud.points.emplace_back(p * static_cast<float>(1.0 + 0.0005 * random.normal()));
  }
  return cloud;
}

void add_moved(Surface& all, const Surface& part, const Eigen::Isometry3d& T) {
  const Surface there = part.seen_from(T.inverse());
  all.points.insert(all.points.end(), there.points.begin(), there.points.end());
  all.normals.insert(all.normals.end(), there.normals.begin(), there.normals.end());
}

// A table top with boxes of other shapes on it, in scene coordinates: z up, the table at zero.
Surface clutter() {
  Random random(3);
  Surface surface;
  surface.add({-0.7, -0.5, 0.0}, {1.4, 0, 0}, {0, 1.0, 0}, kSpacing_m, random);
  add_box(surface, {-0.55, 0.1, 0.0}, {0.2, 0.25, 0.15}, random);
  add_box(surface, {0.35, 0.2, 0.0}, {0.15, 0.1, 0.3}, random);
  add_box(surface, {-0.5, -0.35, 0.0}, {0.12, 0.12, 0.12}, random);
  return surface;
}

// The sensor looks down at the table from 1.1 m.
Eigen::Isometry3d sensor_pose() { return testing::look_at({0.1, -0.9, 0.8}, {0.05, 0.0, 0.1}); }

std::unique_ptr<Localizer> crane_database() {
  IndexOptions options;
  options.kind = EntryKind::kObject;
  return testing::localizer_of({testing::describe("crane", cloud_of(crane()), options)});
}

TEST(SearchObjects, FindsAModelThatStandsInClutter) {
  Eigen::Isometry3d T_table_crane = Eigen::Isometry3d::Identity();
  T_table_crane.linear() = rotation_from_vector({0, 0, -0.6});
  T_table_crane.translation() = Eigen::Vector3d(0.05, -0.05, 0.0);
  Surface table = clutter();
  add_moved(table, crane(), T_table_crane);
  const Eigen::Isometry3d T_table_sensor = sensor_pose();
  const PointCloud view = seen_from_zero(table.seen_from(T_table_sensor));
  ASSERT_GT(view.size(), 10'000U);
  const QueryResult answer = crane_database()->query(view, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_EQ(answer.hypotheses[0].scene, "crane");
  EXPECT_THAT(answer.hypotheses[0].T_scene_sensor,
              PoseNear(T_table_crane.inverse() * T_table_sensor, 0.02, 0.03));
}

TEST(SearchObjects, DoesNotFindAModelThatIsNotThere) {
  const PointCloud view = seen_from_zero(clutter().seen_from(sensor_pose()));
  const QueryResult answer = crane_database()->query(view, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kNotFound);
  EXPECT_NE(answer.reason, "");
}

TEST(SearchObjects, AnswersAlikeInMillimetresAndMetresWithAPowerOfTwoBetween) {
  // Scaled by 1/8 an object is described alike, point for point: the answer scales with it.
  Surface model = crane();
  Surface table = clutter();
  Eigen::Isometry3d T_table_crane = Eigen::Isometry3d::Identity();
  T_table_crane.translation() = Eigen::Vector3d(0.05, -0.05, 0.0);
  add_moved(table, model, T_table_crane);
  PointCloud view = seen_from_zero(table.seen_from(sensor_pose()));
  const auto ask = [&](float scale) {
    Surface scaled = model;
    for (Eigen::Vector3f& p : scaled.points) p *= scale;
    PointCloud seen = view;
    for (Eigen::Vector3f& p : seen.points) p *= scale;
    IndexOptions options;
    options.kind = EntryKind::kObject;
    const auto database =
        testing::localizer_of({testing::describe("crane", cloud_of(scaled), options)});
    return database->query(seen, {}, {});
  };
  const QueryResult metres = ask(1.0F);
  const QueryResult small = ask(0.125F);
  EXPECT_EQ(metres.status, small.status);
  ASSERT_FALSE(metres.hypotheses.empty());
  ASSERT_FALSE(small.hypotheses.empty());
  Eigen::Isometry3d expected(metres.hypotheses[0].T_scene_sensor);
  expected.translation() *= 0.125;
  EXPECT_THAT(small.hypotheses[0].T_scene_sensor, PoseNear(expected, 1e-3, 1e-2));
}

TEST(SearchObjects, LeavesPlacesToAnswerBesideObjects) {
  const testing::SyntheticScene room = testing::small_room(2);
  IndexOptions options;
  options.kind = EntryKind::kObject;
  const auto database =
      testing::localizer_of({testing::describe("crane", cloud_of(crane()), options),
                             testing::describe_room("room", room)});
  const testing::Frame frame = testing::frame_in(room, 1);
  const QueryResult answer = database->query(frame.cloud, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_EQ(answer.hypotheses[0].scene, "room");
  EXPECT_THAT(answer.hypotheses[0].T_scene_sensor, PoseNear(frame.T_scene_sensor, 0.05, 0.035));
}

TEST(SearchObjects, IsNotKeptFromAnswersByAPlaceTooCoarseForTheQuery) {
  // The place is described at metres: all of the table top is one voxel of it.
  const testing::SyntheticScene room = testing::small_room(2);
  PointCloud street = room.cloud;
  for (Eigen::Vector3f& p : street.points) p *= 200.0F;
  for (Eigen::Vector3f& v : street.viewpoints) v *= 200.0F;
  IndexOptions options;
  options.kind = EntryKind::kObject;
  const auto database =
      testing::localizer_of({testing::describe("street", street, {}),
                             testing::describe("crane", cloud_of(crane()), options)});
  Eigen::Isometry3d T_table_crane = Eigen::Isometry3d::Identity();
  T_table_crane.translation() = Eigen::Vector3d(0.05, -0.05, 0.0);
  Surface table = clutter();
  add_moved(table, crane(), T_table_crane);
  const PointCloud view = seen_from_zero(table.seen_from(sensor_pose()));
  const QueryResult answer = database->query(view, {}, {});
  EXPECT_EQ(answer.status, QueryStatus::kLocalized) << answer.reason;
  ASSERT_FALSE(answer.hypotheses.empty());
  EXPECT_EQ(answer.hypotheses[0].scene, "crane");
}

}  // namespace
}  // namespace landmarkdb
