#include "engine/retrieval/scene_view.hpp"

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/engine/retrieval/rooms.hpp"

namespace landmarkdb {
namespace {

using testing::describe_room;
using testing::Frame;
using testing::frame_in;
using ::testing::IsEmpty;
using testing::localizer_of;
using testing::small_room;
using testing::SyntheticScene;

struct Lobby {
  SyntheticScene scene = small_room(2);
  SceneRecord record = describe_room("lobby", scene);
  std::unique_ptr<Localizer> localizer = localizer_of({record});
};

const Lobby& lobby() {
  static const Lobby made;
  return made;
}

QueryResult ask(std::uint32_t points) {
  QueryOptions options;
  options.want_scene_points = points;
  return lobby().localizer->query(frame_in(lobby().scene, 1).cloud, options, {});
}

TEST(SceneView, IsLeftOutUnlessAskedFor) { EXPECT_THAT(ask(0).scene_views, IsEmpty()); }

TEST(SceneView, HoldsNoMorePointsThanAskedForAndIsMadeForTheFirstHypotheses) {
  for (const std::uint32_t most : {1U, 10U, 500U, 50'000U}) {
    const QueryResult answer = ask(most);
    EXPECT_EQ(answer.scene_views.size(), std::min(answer.hypotheses.size(), kMostSceneViews));
    for (const SceneView& view : answer.scene_views) {
      EXPECT_GE(view.points.size(), 1U);
      EXPECT_LE(view.points.size(), most);
      EXPECT_EQ(view.scene_points, lobby().record.prepared.size());
      EXPECT_GE(view.spacing_m, lobby().record.prepared.resolution_m);
    }
  }
}

TEST(SceneView, HoldsTheSurfaceTheQueryLiesOn) {
  const Frame frame = frame_in(lobby().scene, 1);
  const QueryResult answer = ask(kMostSceneViewPoints);
  ASSERT_FALSE(answer.scene_views.empty());
  const SceneView& view = answer.scene_views[0];
  const Eigen::Matrix4d& T = answer.hypotheses[0].T_scene_sensor;
  std::size_t near = 0;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < frame.cloud.size(); i += 200) {
    const Eigen::Vector4d p = T * frame.cloud.points[i].cast<double>().homogeneous();
    if (!p.allFinite()) continue;
    ++asked;
    double closest = 1e9;
    for (const Eigen::Vector3f& q : view.points) {
      closest = std::min(closest, (view.origin + q.cast<double>() - p.head<3>()).norm());
    }
    near += closest < 3.0 * view.spacing_m ? 1U : 0U;
  }
  EXPECT_GT(near, asked * 8 / 10);
}

TEST(SceneView, RefusesMorePointsThanItEverSends) {
  EXPECT_THROW(ask(kMostSceneViewPoints + 1), Error);
}

}  // namespace
}  // namespace landmarkdb
