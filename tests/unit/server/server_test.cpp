#include "server/server.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "store/store.hpp"
#include "tests/support/make_scene.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::bytes_of_file;
using landmarkdb::testing::float_message;
using landmarkdb::testing::make_blob;
using landmarkdb::testing::make_database;
using landmarkdb::testing::make_record;
using landmarkdb::testing::make_view;
using landmarkdb::testing::query_envelope;
using landmarkdb::testing::RunningServer;
using landmarkdb::testing::TemporaryFolder;
using landmarkdb::testing::TestClient;
using landmarkdb::testing::wait_until_loaded;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using namespace std::chrono_literals;

v1::Envelope numbered(std::uint64_t request_id) {
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  return envelope;
}

v1::Envelope add_envelope(std::uint64_t request_id, const std::string& name) {
  v1::Envelope envelope = numbered(request_id);
  v1::SceneAddRequest& add = *envelope.mutable_scene_add();
  add.set_name(name);
  add.set_voxel_m(0.08);
  const auto scene =
      landmarkdb::testing::make_scene({.seed = 2, .furniture = 8, .stations = 2, .rays = 8'000});
  for (const PointCloud& cloud : scene.scans)
    *add.add_scans()->mutable_cloud() = float_message(cloud);
  return envelope;
}

Error refusal(const ServerOptions& options) {
  std::ostringstream text;
  Logger log(text, LogLevel::kOff, false);
  try {
    const Server server(options, log);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "the server was made";
  return {ErrorCode::kUnknown, ""};
}

TEST(Server, LeavesTheDatabasesBytesAsTheyAre) {
  RunningServer running;
  const std::string before = bytes_of_file(running.options.db);
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 3; ++id) {
    EXPECT_TRUE(client.call(query_envelope(id, make_view())).has_query_result());
  }
  v1::Envelope list = numbered(9);
  list.mutable_scene_list();
  EXPECT_TRUE(client.call(list).has_scene_list_reply());
  running.server.reset();
  EXPECT_EQ(bytes_of_file(running.options.db), before);
}

TEST(Server, AddsAndRemovesScenesOverTheSocket) {
  RunningServer running;
  TestClient client = running.client();
  const v1::Envelope added = client.call(add_envelope(1, "second"));
  ASSERT_TRUE(added.has_scene_reply()) << added.DebugString();
  EXPECT_EQ(added.scene_reply().scene().version(), 1);

  v1::Envelope list = numbered(2);
  list.mutable_scene_list();
  EXPECT_THAT(client.call(list).scene_list_reply().scenes(), SizeIs(2));
  v1::Envelope query = query_envelope(3, make_view(2));
  query.mutable_query()->mutable_options()->add_scenes("second");
  EXPECT_TRUE(client.call(query).has_query_result()) << "in service once the answer is there";

  v1::Envelope remove = numbered(4);
  remove.mutable_scene_remove()->set_name("second");
  EXPECT_TRUE(client.call(remove).has_scene_remove_reply());
  query.set_request_id(5);
  EXPECT_EQ(client.call(query).error().code(), v1::CODE_NOT_FOUND);
}

TEST(Server, ReloadsOnRequest) {
  RunningServer running;
  TestClient client = running.client();
  Store::open_read_write(running.options.db).insert(make_record("second", 2), {});
  v1::Envelope reload = numbered(1);
  reload.mutable_reload();
  EXPECT_EQ(client.call(reload).reload_reply().scenes(), 2U);
}

TEST(Server, AnswersOverAUnixSocket) {
  const TemporaryFolder folder;
  RunningServer running({.unix_path = folder.file("s.sock")});
  TestClient client = TestClient::unix_socket(folder.file("s.sock"));
  EXPECT_TRUE(client.hello().has_hello_reply());
  EXPECT_TRUE(wait_until_loaded(client).ready());
  running.server.reset();
  EXPECT_FALSE(std::filesystem::exists(folder.file("s.sock")));
}

TEST(Server, TellsAClientTooManyWhyAndCloses) {
  RunningServer running({.max_connections = 2});
  // The one that waited for the load may still count for a moment.
  std::vector<TestClient> clients;
  while (clients.size() < 2) {
    TestClient client = TestClient::tcp(running.server->port());
    if (client.hello().has_hello_reply()) clients.push_back(std::move(client));
  }
  TestClient third = TestClient::tcp(running.server->port());
  const v1::Envelope reply = third.hello();
  EXPECT_EQ(reply.error().code(), v1::CODE_RESOURCE_EXHAUSTED);
  EXPECT_THAT(reply.error().message(), HasSubstr("--max-connections"));
  EXPECT_TRUE(third.closed_by_server());
  EXPECT_TRUE(wait_until_loaded(clients[0]).ready());
}

// Strangers used to take the places of clients for ten seconds each.
TEST(Server, LeavesClientsTheirPlacesWhateverStrangersDo) {
  RunningServer running({.max_connections = 2, .max_strangers = 3});
  std::vector<TestClient> strangers;
  for (int i = 0; i < 12; ++i) strangers.push_back(TestClient::tcp(running.server->port()));
  EXPECT_TRUE(strangers.front().closed_by_server()) << "the oldest makes room";
  TestClient client = TestClient::tcp(running.server->port());
  EXPECT_TRUE(client.hello().has_hello_reply());
  for (int i = 0; i < 12; ++i) strangers.push_back(TestClient::tcp(running.server->port()));
  EXPECT_TRUE(wait_until_loaded(client).ready()) << "who has said Hello stays";
}

TEST(Server, RefusesACloudForWhichItHasNoMemory) {
  RunningServer running({.max_message_bytes = 1 << 20, .memory_budget_bytes = 1 << 20});
  TestClient client = running.client();
  v1::Envelope query = query_envelope(1, make_blob());
  v1::Cloud& cloud = *query.mutable_query()->mutable_clouds(0);
  cloud.set_points(1'000'000);
  cloud.set_zstd(true);
  const v1::Envelope reply = client.call(query);
  EXPECT_EQ(reply.error().code(), v1::CODE_RESOURCE_EXHAUSTED);
  EXPECT_THAT(reply.error().message(), HasSubstr("limit of 1048576"));
}

TEST(Server, ServesTheRestWhenASceneIsDamaged) {
  const TemporaryFolder folder;
  const std::string db = folder.file("places.db");
  make_database(db);
  Store::open_read_write(db).insert(make_record("second", 2), {});
  // The float32 descriptors of "room" lie in the first half of the file; flip bits in the middle of
  // a page there until the store notices.
  std::string bytes = bytes_of_file(db);
  std::uint64_t damaged = 0;
  for (std::size_t at = bytes.size() / 4; damaged == 0 && at < bytes.size(); at += 40'000) {
    std::string broken = bytes;
    for (std::size_t i = 0; i < 64; ++i) broken[at + i] = static_cast<char>(~broken[at + i]);
    std::ofstream(db, std::ios::binary).write(broken.data(), static_cast<long>(broken.size()));
    std::uint64_t left_out = 0;
    const auto catalog =
        Store::open_read_only(db).load_catalog({}, [&](const DamagedScene&) { ++left_out; });
    if (left_out == 1 && catalog->entries.size() == 1) damaged = at;
  }
  ASSERT_GT(damaged, 0U);

  RunningServer running({.db = db});
  TestClient client = running.client();
  const v1::HealthReply health = wait_until_loaded(client);
  EXPECT_EQ(health.status(), v1::HEALTH_STATUS_DEGRADED);
  EXPECT_TRUE(health.ready());
  EXPECT_THAT(health.quarantined(), SizeIs(1));
  EXPECT_THAT(health.problems(0), HasSubstr("landmarkdb-indexer check"));
  EXPECT_TRUE(client.call(query_envelope(1, make_blob())).has_query_result());
  v1::Envelope show = numbered(2);
  show.mutable_scene_show()->set_name(health.quarantined(0));
  EXPECT_EQ(client.call(show).scene_reply().scene().state(), v1::SCENE_STATE_QUARANTINED);
}

TEST(Server, SaysWhatItCannotServe) {
  const TemporaryFolder folder;
  EXPECT_EQ(refusal({.db = folder.file("missing.db"), .listen = "127.0.0.1:0"}).code(),
            ErrorCode::kInvalidArgument);
  const std::string db = folder.file("places.db");
  make_database(db);
  EXPECT_EQ(refusal({.db = db, .listen = "none"}).field(), "--listen");
  EXPECT_EQ(refusal({.db = db, .listen = "0.0.0.0:0"}).code(), ErrorCode::kPermissionDenied);
  EXPECT_EQ(refusal({.db = db, .listen = "127.0.0.1:0", .max_message_bytes = 10}).field(),
            "--max-message");
  const RunningServer first({.db = db});
  EXPECT_EQ(refusal({.db = db, .listen = first.server->addresses().at(0)}).code(),
            ErrorCode::kUnavailable);
}

TEST(Server, WritesItsPortToAFile) {
  const TemporaryFolder folder;
  const RunningServer running({.port_file = folder.file("port")});
  EXPECT_EQ(bytes_of_file(folder.file("port")), std::to_string(running.server->port()) + "\n");
}

TEST(Server, StopsWithGoAwayWhenNothingIsOpen) {
  RunningServer running;
  TestClient client = running.client();
  running.server->stop();
  EXPECT_TRUE(client.receive()->has_go_away());
  EXPECT_TRUE(client.closed_by_server());
  running.server->wait();
}

TEST(Server, FinishesOrCancelsOpenRequestsWhenItStops) {
  RunningServer running({.threads = 1, .stop_cancel_after = 50ms, .stop_cut_after = 5s});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 10; ++id) client.send(query_envelope(id, make_view()));
  v1::Envelope ping = numbered(100);
  ping.mutable_ping();
  client.send(ping);
  int answers = 0;
  while (const auto message = client.receive()) {
    // All requests before the ping have been taken; the first may be answered by then.
    if (message->request_id() == 100 && !message->has_progress()) running.server->stop();
    if (message->has_query_result() || message->has_error()) ++answers;
  }
  EXPECT_EQ(answers, 10) << "each request got its answer or CANCELLED";
  running.server->wait();
}

TEST(Server, StopsOnASignalAndReloadsOnAnother) {
  RunningServer running;
  running.server->stop_on_signals();
  TestClient client = running.client();
  Store::open_read_write(running.options.db).insert(make_record("second", 2), {});
  std::raise(SIGHUP);
  v1::Envelope stats = numbered(0);
  for (std::uint64_t id = 1; id < 2'000; ++id) {
    stats.set_request_id(id);
    stats.mutable_stats();
    if (client.call(stats).stats_reply().scenes() == 2) break;
    std::this_thread::sleep_for(5ms);
  }
  stats.set_request_id(9'999);
  EXPECT_EQ(client.call(stats).stats_reply().scenes(), 2U);
  std::raise(SIGTERM);
  running.server->wait();
  EXPECT_TRUE(client.closed_by_server());
}

}  // namespace
}  // namespace landmarkdb
