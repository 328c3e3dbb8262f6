#include "server/convert_scene.hpp"

#include <functional>
#include <limits>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

v1::SceneAddRequest good_request() {
  v1::SceneAddRequest request;
  request.set_name("lobby");
  request.set_kind(v1::ENTRY_KIND_OBJECT);
  request.set_voxel_m(0.05);
  request.mutable_up()->set_z(1.0);
  v1::SceneAddScan& scan = *request.add_scans();
  scan.set_source("/home/me/scans/a.ply");
  scan.mutable_cloud()->set_encoding(v1::POINT_ENCODING_FLOAT32);
  scan.mutable_cloud()->set_xyz(std::string(24, '\0'));
  for (int i = 0; i < 16; ++i) scan.add_t_scene_cloud(i % 5 == 0 ? 1.0 : 0.0);
  scan.set_t_scene_cloud(3, 7.0);
  return request;
}

TEST(SceneAdditionFromProto, CarriesScansPosesAndOptions) {
  PointAllowance allowance;
  const SceneAddition addition = from_proto(good_request(), allowance);
  EXPECT_EQ(addition.name, "lobby");
  EXPECT_EQ(addition.options.kind, EntryKind::kObject);
  EXPECT_EQ(addition.options.voxel_m, 0.05);
  EXPECT_FALSE(addition.options.radius_m.has_value());
  ASSERT_THAT(addition.scans, SizeIs(1));
  EXPECT_EQ(addition.scans[0].source, "a.ply") << "folders of another machine are left out";
  EXPECT_EQ(addition.scans[0].T_scene_cloud.translation().x(), 7.0);
  EXPECT_EQ(addition.scans[0].cloud.size(), 2U);
}

TEST(SceneAdditionFromProto, CountsThePointsOfAllScansTogether) {
  v1::SceneAddRequest request = good_request();
  *request.add_scans() = request.scans(0);
  PointAllowance four{4};
  EXPECT_THAT(from_proto(request, four).scans, SizeIs(2));
  PointAllowance three{3};
  EXPECT_THROW(from_proto(request, three), Error);
}

TEST(SceneAdditionFromProto, RefusesWhatCannotBeAndNamesTheField) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    std::function<void(v1::SceneAddRequest&)> spoil;
  };
  const std::vector<Case> cases = {
      {"scans", [](auto& r) { r.clear_scans(); }},
      {"scans",
       [](auto& r) {
         for (int i = 0; i < 5000; ++i) r.add_scans();
       }},
      {"kind", [](auto& r) { r.set_kind(v1::EntryKind(9)); }},
      {"voxel_m", [](auto& r) { r.set_voxel_m(0.0); }},
      {"voxel_m", [&](auto& r) { r.set_voxel_m(nan); }},
      {"radius_m", [](auto& r) { r.set_radius_m(-1.0); }},
      {"keypoints", [](auto& r) { r.set_keypoints(v1::KeypointMethod(77)); }},
      {"up", [](auto& r) { r.mutable_up()->set_z(0.0); }},
      {"scans[0].t_scene_cloud", [](auto& r) { r.mutable_scans(0)->add_t_scene_cloud(1.0); }},
      {"scans[0].t_scene_cloud", [&](auto& r) { r.mutable_scans(0)->set_t_scene_cloud(0, nan); }},
      {"scans[0].cloud.xyz", [](auto& r) { r.mutable_scans(0)->mutable_cloud()->set_xyz("x"); }},
      {"scans[0].source", [](auto& r) { r.mutable_scans(0)->set_source(std::string(2000, 'a')); }},
  };
  for (std::size_t i = 0; i < cases.size(); ++i) {
    v1::SceneAddRequest request = good_request();
    cases[i].spoil(request);
    try {
      PointAllowance allowance;
      from_proto(request, allowance);
      ADD_FAILURE() << "case " << i << " was taken, " << cases[i].field;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << "case " << i;
      EXPECT_EQ(error.field(), cases[i].field) << "case " << i;
    }
  }
}

TEST(LandmarkFromProto, WantsABoxWithAVolume) {
  v1::Landmark message;
  message.set_name("door");
  message.mutable_max_m()->set_x(1);
  message.mutable_max_m()->set_y(1);
  EXPECT_THROW(from_proto(message), Error);
  message.mutable_max_m()->set_z(2);
  EXPECT_EQ(from_proto(message).max_m.z(), 2.0);
}

TEST(SceneInfoToProto, ShowsDamageAsQuarantine) {
  SceneSummary scene;
  scene.name = "lobby";
  scene.active_version = 2;
  scene.tags["floor"] = "1";
  scene.versions.resize(2);
  scene.warnings = {"units_suspect"};
  EXPECT_EQ(to_proto(scene, true, "").state(), v1::SCENE_STATE_ACTIVE);
  EXPECT_THAT(to_proto(scene, true, "").versions(), SizeIs(2));
  EXPECT_THAT(to_proto(scene, false, "").versions(), SizeIs(0));
  EXPECT_THAT(to_proto(scene, false, "").warnings(), ElementsAre("units_suspect"));
  const v1::SceneInfo left_out = to_proto(scene, false, "points: digest differs");
  EXPECT_EQ(left_out.state(), v1::SCENE_STATE_QUARANTINED);
  EXPECT_EQ(left_out.state_reason(), "points: digest differs");
  scene.damage = "marked";
  EXPECT_EQ(to_proto(scene, false, "").state(), v1::SCENE_STATE_QUARANTINED);
}

}  // namespace
}  // namespace landmarkdb
