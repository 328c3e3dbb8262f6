#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/track_store.hpp"
#include "store/store.hpp"
#include "tests/unit/server/server_support.hpp"
#include "tests/unit/server/track_messages.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::frame_request;
using landmarkdb::testing::MovingBox;
using landmarkdb::testing::open_request;
using landmarkdb::testing::RunningServer;
using landmarkdb::testing::TemporaryFolder;
using landmarkdb::testing::TestClient;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

class TrackSession : public ::testing::Test {
 protected:
  TrackSession() {
    options.db = folder.file("models.db");
    Store::create_or_open(options.db).insert_model(*box.record, {}, {});
    running = std::make_unique<RunningServer>(options);
  }

  v1::Envelope open(std::uint64_t id) const {
    v1::Envelope envelope;
    envelope.set_request_id(id);
    *envelope.mutable_track_open() = open_request(box);
    return envelope;
  }
  v1::Envelope frame(std::uint64_t id, std::uint32_t track, int number) const {
    v1::Envelope envelope;
    envelope.set_request_id(id);
    *envelope.mutable_track_frame() = frame_request(box, track, number);
    return envelope;
  }
  v1::StatsReply stats() {
    v1::Envelope envelope;
    envelope.set_request_id(1);
    envelope.mutable_stats();
    return running->client().call(envelope).stats_reply();
  }

  MovingBox box;
  TemporaryFolder folder;
  ServerOptions options;
  std::unique_ptr<RunningServer> running;
};

TEST_F(TrackSession, PipelinedFramesAreAnsweredInTheirOrder) {
  TestClient client = running->client();
  client.send(open(1));
  for (int i = 0; i < 20; ++i) client.send(frame(static_cast<std::uint64_t>(i) + 2, 1, i));
  EXPECT_EQ(client.receive()->track_open_reply().track(), 1U);
  for (int i = 0; i < 20; ++i) {
    const v1::Envelope reply = *client.receive();
    EXPECT_EQ(reply.request_id(), static_cast<std::uint64_t>(i) + 2);
    const v1::TrackFrameResult& result = reply.track_frame_result();
    EXPECT_EQ(result.frame(), static_cast<std::uint64_t>(i) + 1);
    EXPECT_EQ(result.status(), i == 0 ? v1::TRACK_STATUS_RECOGNIZED : v1::TRACK_STATUS_TRACKED);
  }
  const v1::StatsReply figures = stats();
  EXPECT_EQ(figures.tracks_open(), 1U);
  EXPECT_EQ(figures.track_frames(), 20U);
  EXPECT_EQ(figures.track_frames_seen(), 20U);
  EXPECT_GT(figures.track_ms_max(), 0.0);
}

TEST_F(TrackSession, TracksOfOneConnectionAreNotThoseOfAnother) {
  TestClient client = running->client();
  client.call(open(1));
  TestClient other = running->client();
  EXPECT_EQ(other.call(frame(1, 1, 0)).error().code(), v1::CODE_NOT_FOUND);
}

TEST_F(TrackSession, TooManyTracksAreRefusedAndTheOthersGoOn) {
  TestClient client = running->client();
  for (std::uint64_t i = 1; i <= kMaxTracks; ++i) client.call(open(i));
  const v1::Envelope refused = client.call(open(90));
  EXPECT_EQ(refused.error().code(), v1::CODE_RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.error().message(), HasSubstr("4 tracks are open"));
  EXPECT_TRUE(client.call(frame(91, 4, 0)).has_track_frame_result());
}

TEST_F(TrackSession, ABadFrameIsToldAndTheNextIsTracked) {
  TestClient client = running->client();
  client.call(open(1));
  client.call(frame(2, 1, 0));
  v1::Envelope bad = frame(3, 1, 1);
  bad.mutable_track_frame()->set_image("no image at all");
  EXPECT_EQ(client.call(bad).error().code(), v1::CODE_INVALID_ARGUMENT);
  EXPECT_EQ(client.call(frame(4, 1, 1)).track_frame_result().status(), v1::TRACK_STATUS_TRACKED);
}

TEST_F(TrackSession, AReloadLeavesTheTrackItsModel) {
  TestClient client = running->client();
  client.call(open(1));
  Store::open_read_write(options.db).remove_model("box");
  v1::Envelope reload;
  reload.set_request_id(2);
  reload.mutable_reload();
  EXPECT_TRUE(client.call(reload).has_reload_reply());
  EXPECT_EQ(client.call(open(3)).error().code(), v1::CODE_NOT_FOUND);
  EXPECT_EQ(client.call(frame(4, 1, 0)).track_frame_result().status(), v1::TRACK_STATUS_RECOGNIZED);
}

TEST_F(TrackSession, AConnectionThatDropsFreesItsTracks) {
  {
    TestClient client = running->client();
    client.call(open(1));
    client.call(open(2));
    EXPECT_EQ(stats().tracks_open(), 2U);
    client.send(frame(3, 1, 0));
    client.reset();
  }
  // The reset is noticed by another thread; a server that keeps them never gets there.
  while (stats().tracks_open() != 0) std::this_thread::sleep_for(5ms);
}

TEST_F(TrackSession, AFrameThatIsCancelledIsAnsweredAndTheTrackGoesOn) {
  TestClient client = running->client();
  client.call(open(1));
  for (std::uint64_t id = 2; id <= 40; ++id) client.send(frame(id, 1, static_cast<int>(id) - 2));
  v1::Envelope cancel;
  cancel.set_request_id(40);
  cancel.mutable_cancel();
  client.send(cancel);
  bool answered = false;
  for (int i = 2; i <= 40; ++i) {
    const v1::Envelope reply = *client.receive();
    if (reply.request_id() != 40) continue;
    answered = true;
    EXPECT_TRUE(reply.error().code() == v1::CODE_CANCELLED || reply.has_track_frame_result());
  }
  EXPECT_TRUE(answered);
  EXPECT_TRUE(client.call(frame(50, 1, 39)).has_track_frame_result());
}

}  // namespace
}  // namespace landmarkdb
