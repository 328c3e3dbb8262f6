#include "server/track_store.hpp"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "tests/unit/server/track_messages.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::arm_file;
using landmarkdb::testing::empty_frame;
using landmarkdb::testing::frame_request;
using landmarkdb::testing::MovingBox;
using landmarkdb::testing::open_request;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class TrackStoreTest : public ::testing::Test {
 protected:
  TrackStoreTest() {
    auto catalog = std::make_shared<MonoCatalog>();
    catalog->entries.push_back({1, box.record, ""});
    served.models = catalog;
    served.recognizer = std::make_shared<const Recognizer>(catalog);
    served.generation = 5;
  }

  std::uint32_t open(const std::string& servo = {}) {
    v1::TrackOpenRequest request = open_request(box);
    request.set_servo(servo);
    return tracks.open(request, served).track();
  }
  v1::TrackFrameResult next(const v1::TrackFrameRequest& request) {
    return tracks.next(request, memory, context);
  }
  template <typename Call>
  static std::string refused(ErrorCode code, const Call& call) {
    try {
      call();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      return error.field();
    }
    return "it was taken";
  }
  void expect_truth(const v1::TrackFrameResult& result, int frame) const {
    ASSERT_THAT(result.t_camera_object(), SizeIs(16)) << result.DebugString();
    const Eigen::Isometry3d T = from_row_major(
        std::span<const double, 16>(result.t_camera_object().data(), std::size_t{16}));
    const Eigen::Isometry3d truth = box.T_camera_object(frame);
    EXPECT_LT((T.translation() - truth.translation()).norm(), 1e-4);
    EXPECT_LT(rotation_angle_rad(T.linear().transpose() * truth.linear()), 1e-3);
  }

  MovingBox box;
  Served served;
  Counters counters;
  MemoryBudget memory{std::size_t{64} << 20U};
  RunContext context;
  TrackStore tracks{counters};
};

TEST_F(TrackStoreTest, RecognisesThenTracks) {
  const std::uint32_t track = open();
  const v1::TrackFrameResult first = next(frame_request(box, track, 0));
  EXPECT_EQ(first.status(), v1::TRACK_STATUS_RECOGNIZED) << first.reason();
  EXPECT_GT(first.confidence(), 0.5);
  expect_truth(first, 0);
  for (int frame = 1; frame < 5; ++frame) {
    const v1::TrackFrameResult result = next(frame_request(box, track, frame));
    EXPECT_EQ(result.status(), v1::TRACK_STATUS_TRACKED);
    EXPECT_EQ(result.frame(), static_cast<std::uint64_t>(frame) + 1);
    EXPECT_EQ(result.confidence(), first.confidence());
    EXPECT_THAT(result.covariance(), SizeIs(36));
    EXPECT_FALSE(result.has_servo());
    expect_truth(result, frame);
  }
  v1::TrackCloseRequest close;
  close.set_track(track);
  EXPECT_EQ(tracks.close(close).frames(), 5U);
}

TEST_F(TrackStoreTest, LosesTheObjectAndFindsItAgain) {
  const std::uint32_t track = open();
  next(frame_request(box, track, 0));
  EXPECT_EQ(next(empty_frame(track)).status(), v1::TRACK_STATUS_PREDICTED);
  next(empty_frame(track));
  const v1::TrackFrameResult lost = next(empty_frame(track));
  EXPECT_EQ(lost.status(), v1::TRACK_STATUS_LOST);
  EXPECT_FALSE(lost.reason().empty());
  EXPECT_THAT(lost.t_camera_object(), SizeIs(0));
  EXPECT_EQ(lost.confidence(), 0.0);
  EXPECT_EQ(next(frame_request(box, track, 9)).status(), v1::TRACK_STATUS_RECOGNIZED);
}

TEST_F(TrackStoreTest, StartsFromAPoseThatIsGiven) {
  v1::TrackOpenRequest request = open_request(box);
  for (const double number : to_row_major(box.T_camera_object(0).matrix())) {
    request.add_start_t_camera_object(number);
  }
  const std::uint32_t track = tracks.open(request, served).track();
  const v1::TrackFrameResult result = next(frame_request(box, track, 1));
  EXPECT_EQ(result.status(), v1::TRACK_STATUS_TRACKED);
  EXPECT_EQ(result.confidence(), 1.0);
}

TEST_F(TrackStoreTest, ABadFrameLeavesTheTrackAsItWas) {
  const std::uint32_t track = open(arm_file(box, 3));
  next(frame_request(box, track, 0));
  const auto spoiled = [&](const auto& spoil) {
    v1::TrackFrameRequest request = frame_request(box, track, 1);
    spoil(request);
    return refused(ErrorCode::kInvalidArgument, [&] { next(request); });
  };
  EXPECT_EQ(spoiled([](auto& r) { r.clear_points(); }), "image");
  EXPECT_EQ(spoiled([](auto& r) { r.set_image("no image"); }), "image");
  EXPECT_EQ(spoiled([](auto& r) { r.set_image("P5\n2 2\n255\nabcd"); }), "camera");
  EXPECT_EQ(spoiled([](auto& r) { r.mutable_points()->mutable_points(0)->set_u(NAN); }),
            "points.points[0].u");
  EXPECT_EQ(spoiled([](auto& r) { r.add_q_rad(1.0); }), "q_rad");
  EXPECT_EQ(spoiled([](auto& r) { r.add_q_at_image_rad(NAN); }), "q_at_image_rad");
  EXPECT_EQ(spoiled([](auto& r) { r.set_time_s(NAN); }), "time_s");
  const v1::TrackFrameResult result = next(frame_request(box, track, 1));
  EXPECT_EQ(result.status(), v1::TRACK_STATUS_TRACKED);
  EXPECT_EQ(result.frame(), 2U);
}

TEST_F(TrackStoreTest, TimeMustGrow) {
  const std::uint32_t track = open();
  v1::TrackFrameRequest request = frame_request(box, track, 0);
  request.set_time_s(10.0);
  EXPECT_EQ(next(request).time_s(), 10.0);
  EXPECT_EQ(refused(ErrorCode::kInvalidArgument, [&] { next(request); }), "time_s");
  request.set_time_s(10.5);
  EXPECT_EQ(next(request).time_s(), 10.5);
}

TEST_F(TrackStoreTest, RefusesWhatCannotBeOpened) {
  const auto spoiled = [&](ErrorCode code, const auto& spoil) {
    v1::TrackOpenRequest request = open_request(box);
    spoil(request);
    return refused(code, [&] { tracks.open(request, served); });
  };
  EXPECT_EQ(spoiled(ErrorCode::kNotFound, [](auto& r) { r.set_model("cup"); }), "model");
  const ErrorCode bad = ErrorCode::kInvalidArgument;
  EXPECT_EQ(spoiled(bad, [](auto& r) { r.mutable_camera()->set_width(0); }), "camera.width");
  EXPECT_EQ(spoiled(bad, [](auto& r) { r.mutable_options()->set_reach_px(0); }),
            "options.reach_px");
  EXPECT_EQ(spoiled(bad, [](auto& r) { r.mutable_options()->set_min_confidence(2); }),
            "options.min_confidence");
  EXPECT_EQ(spoiled(bad, [](auto& r) { r.add_start_t_camera_object(1); }), "start_t_camera_object");
  EXPECT_EQ(spoiled(bad, [](auto& r) { r.set_servo("{}"); }), "servo");
  EXPECT_EQ(counters.tracks_open, 0U);
}

TEST_F(TrackStoreTest, OneTrackTooManyIsRefusedUntilOneIsClosed) {
  for (std::size_t i = 0; i < kMaxTracks; ++i) open();
  EXPECT_EQ(counters.tracks_open, kMaxTracks);
  EXPECT_THROW(open(), Error);
  v1::TrackCloseRequest close;
  close.set_track(2);
  tracks.close(close);
  EXPECT_EQ(open(), kMaxTracks + 1) << "a number is not used twice";
  EXPECT_EQ(refused(ErrorCode::kNotFound, [&] { tracks.close(close); }), "track");
  EXPECT_EQ(refused(ErrorCode::kNotFound, [&] { next(empty_frame(2)); }), "track");
}

TEST_F(TrackStoreTest, FreesWhatIsOpenWhenItGoes) {
  {
    TrackStore other{counters};
    other.open(open_request(box), served);
    EXPECT_EQ(counters.tracks_open, 1U);
  }
  EXPECT_EQ(counters.tracks_open, 0U);
}

TEST_F(TrackStoreTest, KeepsItsModelWhenAnotherCatalogueIsServed) {
  const std::uint32_t track = open();
  served = {};
  served.models = std::make_shared<MonoCatalog>();
  EXPECT_EQ(next(frame_request(box, track, 0)).status(), v1::TRACK_STATUS_RECOGNIZED);
}

TEST_F(TrackStoreTest, LeadsAnArmByWhatItSees) {
  const std::uint32_t track = open(arm_file(box, 3));
  const v1::ServoCommand first = next(frame_request(box, track, 0)).servo();
  EXPECT_EQ(first.status(), v1::SERVO_STATUS_RUNNING);
  EXPECT_EQ(first.rank(), 6U);
  EXPECT_THAT(first.twist(), SizeIs(6));
  EXPECT_THAT(first.error(), SizeIs(6));
  ASSERT_THAT(first.joint_rates_rad_s(), SizeIs(6));
  EXPECT_NEAR(first.rotation_rad(), 0.03, 1e-3) << "three steps of the box";
  const v1::ServoCommand second = next(frame_request(box, track, 1)).servo();
  constexpr double kCycle_s = 0.08;
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(second.q_rad(i), first.q_rad(i) + kCycle_s * first.joint_rates_rad_s(i), 1e-12);
  }
  v1::TrackFrameRequest there = frame_request(box, track, 3);
  for (const double angle : {0.25, 0.585398, -2.891593, 0.3, 0.747198, 0.5}) {
    there.add_q_rad(angle);
  }
  next(frame_request(box, track, 2));
  const v1::ServoCommand third = next(there).servo();
  EXPECT_LT(third.rotation_rad(), 1e-3) << "it sees the box as it should";
  EXPECT_EQ(third.q_rad(5), 0.5);
  next(empty_frame(track));
  const v1::ServoCommand stopped = next(empty_frame(track)).servo();
  EXPECT_EQ(stopped.status(), v1::SERVO_STATUS_STOPPED);
  for (const double rate : stopped.joint_rates_rad_s()) EXPECT_EQ(rate, 0.0);
}

TEST_F(TrackStoreTest, WantsJointAnglesFromSomewhere) {
  std::string arm = arm_file(box, 3);
  arm.erase(arm.find("\"q\""), arm.find("\"T_camera_object\"") - arm.find("\"q\""));
  const std::uint32_t track = open(arm);
  EXPECT_EQ(refused(ErrorCode::kInvalidArgument, [&] { next(frame_request(box, track, 0)); }),
            "q_rad");
  v1::TrackFrameRequest request = frame_request(box, open(), 0);
  request.add_q_rad(0.1);
  EXPECT_EQ(refused(ErrorCode::kInvalidArgument, [&] { next(request); }), "q_rad")
      << "a track without an arm has no joints";
}

TEST_F(TrackStoreTest, StopsWhenToldTo) {
  const std::uint32_t track = open();
  std::stop_source stop;
  stop.request_stop();
  context.stop = stop.get_token();
  EXPECT_THROW(next(frame_request(box, track, 0)), Error);
  context = {};
  EXPECT_EQ(next(frame_request(box, track, 0)).status(), v1::TRACK_STATUS_RECOGNIZED);
}

}  // namespace
}  // namespace landmarkdb
