#include "server/convert_track.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/convert_track.hpp"
#include "engine/base/error.hpp"
#include "server/convert_recognition.hpp"

namespace landmarkdb {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(ConvertTrack, WhatAClientSendsArrivesAsItWas) {
  client::TrackSetup setup;
  setup.camera.width = 4;
  setup.camera.height = 3;
  setup.camera.fx = setup.camera.fy = 5.0;
  setup.model = "box";
  setup.servo = "{}";
  setup.start = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3));
  setup.recognize.min_confidence = 0.25;
  setup.recognize.max_depth_m = 3.0;
  setup.recognize.seed = 7;
  const v1::TrackOpenRequest open = client::to_proto(setup);
  EXPECT_EQ(open.model(), "box");
  EXPECT_EQ(open.servo(), "{}");
  EXPECT_EQ(pose_from(open.start_t_camera_object(), "start")->matrix(), setup.start->matrix());
  const TrackOptions options = from_proto(open.options());
  EXPECT_EQ(options.recognize.min_confidence, 0.25);
  EXPECT_EQ(options.recognize.max_depth_m, 3.0);
  EXPECT_EQ(options.recognize.seed, 7U);
  EXPECT_EQ(options.patience, TrackOptions{}.patience);

  client::TrackInput input;
  input.points = {{FeatureType::kCentroid, {1.5, 2.5}, {}}, {FeatureType::kVertex, {0, 1}, {}}};
  input.links = {{0, 1}};
  input.time_s = 4.5;
  input.q_rad = {0.5};
  input.q_at_image_rad = {0.25};
  const v1::TrackFrameRequest frame = client::to_proto(input, 3);
  EXPECT_EQ(frame.track(), 3U);
  EXPECT_EQ(frame.time_s(), 4.5);
  Arm arm;
  arm.joints.resize(1);
  EXPECT_EQ((*joints_from(frame.q_rad(), arm, "q_rad"))(0), 0.5);
  EXPECT_EQ((*joints_from(frame.q_at_image_rad(), arm, "q"))(0), 0.25);
  EXPECT_THAT(from_proto(frame.points(), setup.camera).links, ElementsAre(ElementsAre(0, 1)));
}

TEST(ConvertTrack, AnAnswerArrivesAsItWasGiven) {
  TrackResult result;
  result.status = TrackStatus::kTracked;
  result.T_camera_object = Eigen::Isometry3d(Eigen::Translation3d(1, 2, 3));
  result.covariance(1, 2) = 0.5;
  result.rms_px = 0.4;
  result.matched = 8;
  result.visible_points = 9;
  result.edge_share = 0.7;
  result.confidence = 0.9;
  v1::TrackFrameResult message = to_proto(result);
  ServoCommand command;
  command.status = ServoStatus::kRunning;
  command.twist(5) = 0.125;
  command.joint_rates = JointVector::Constant(2, 0.5);
  command.error = Eigen::VectorXd::Constant(6, 0.25);
  command.rank = 6;
  command.at_limit = {1};
  *message.mutable_servo() = to_proto(command, JointVector::Constant(2, 1.5));
  const client::TrackedFrame seen = client::from_proto(message);
  EXPECT_EQ(seen.status, "tracked");
  EXPECT_TRUE(seen.seen());
  EXPECT_EQ(seen.T_camera_object->matrix(), result.T_camera_object->matrix());
  EXPECT_EQ(seen.covariance.at(8), 0.5);
  EXPECT_EQ(seen.matched, 8U);
  EXPECT_EQ(seen.confidence, 0.9);
  EXPECT_EQ(seen.servo->status, "running");
  EXPECT_THAT(seen.servo->twist, ElementsAre(0, 0, 0, 0, 0, 0.125));
  EXPECT_THAT(seen.servo->joint_rates_rad_s, ElementsAre(0.5, 0.5));
  EXPECT_THAT(seen.servo->error, SizeIs(6));
  EXPECT_THAT(seen.servo->at_limit, ElementsAre(2));  // counted from 1
  EXPECT_THAT(seen.servo->q_rad, ElementsAre(1.5, 1.5));
}

TEST(ConvertTrack, AnAnswerThatCannotBeIsTheServersMistake) {
  EXPECT_THROW(client::from_proto(v1::TrackFrameResult{}), Error);
  v1::TrackFrameResult poseless;
  poseless.set_status(v1::TRACK_STATUS_TRACKED);
  EXPECT_THROW(client::from_proto(poseless), Error);
  poseless.set_status(v1::TRACK_STATUS_LOST);
  EXPECT_FALSE(client::from_proto(poseless).seen());
}

}  // namespace
}  // namespace landmarkdb
