#include "client/client.hpp"

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/client/fake_server.hpp"

namespace landmarkdb::client {
namespace {

using testing::FakePeer;
using testing::FakeServer;
using ::testing::HasSubstr;

ConnectOptions at(const FakeServer& server) {
  ConnectOptions options;
  options.server = server.address();
  return options;
}

std::vector<QueryCloud> one_point() {
  QueryCloud one;
  one.cloud.points = {{1.0F, 2.0F, 3.0F}};
  return {one};
}

// Answers one request with what `answer` makes of it.
template <typename Answer>
auto replying(Answer answer, const std::string& feature = "zstd") {
  return [answer, feature](FakePeer& peer) {
    peer.greet(feature);
    const std::optional<v1::Envelope> request = peer.receive();
    if (!request) return;
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    answer(*request, reply);
    peer.send(reply);
    peer.receive();
  };
}

TEST(Client, TellsWhatTheServerSaidOfItself) {
  FakeServer server([](FakePeer& peer) { peer.greet(); });
  const Client client(at(server), {});
  EXPECT_EQ(client.server().version, "9.8.7");
  EXPECT_EQ(client.server().max_points, 50'000U);
}

TEST(Client, AsksAQueryAndReadsItsAnswer) {
  FakeServer server(replying([](const v1::Envelope& request, v1::Envelope& reply) {
    const bool good = request.query().clouds_size() == 1 && request.query().clouds(0).zstd() &&
                      request.query().options().seed() == 5;
    reply.mutable_query_result()->set_status(v1::QUERY_STATUS_NOT_FOUND);
    reply.mutable_query_result()->set_reason(good ? "match" : "bad request");
  }));
  Client client(at(server), {});
  QueryOptions options;
  options.seed = 5;
  const QueryResult result = client.query(one_point(), options, {});
  EXPECT_EQ(result.status, QueryStatus::kNotFound);
  EXPECT_EQ(result.reason, "match");
}

TEST(Client, CompressesOnlyForServersThatUnpack) {
  FakeServer server(replying(
      [](const v1::Envelope& request, v1::Envelope& reply) {
        reply.mutable_query_result()->set_status(v1::QUERY_STATUS_NOT_FOUND);
        reply.mutable_query_result()->set_reason(request.query().clouds(0).zstd() ? "zstd" : "raw");
      },
      "int16"));
  Client client(at(server), {});
  EXPECT_EQ(client.query(one_point(), {}, {}).reason, "raw");
}

TEST(Client, RefusesACloudWithMorePointsThanTheServerTakes) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    peer.receive();
  });
  Client client(at(server), {});
  std::vector<QueryCloud> clouds(2);  // together one too many
  clouds[0].cloud.points.resize(50'000, Eigen::Vector3f::Zero());
  clouds[1].cloud.points.resize(1, Eigen::Vector3f::Zero());
  try {
    client.query(clouds, {}, {});
    FAIL() << "sent";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
    EXPECT_THAT(error.what(), HasSubstr("50001 points"));
  }
}

TEST(Client, RefusesAnAnswerOfAnotherKind) {
  FakeServer server(
      replying([](const v1::Envelope&, v1::Envelope& reply) { reply.mutable_reload_reply(); }));
  Client client(at(server), {});
  EXPECT_THROW(client.stats({}), Error);
}

TEST(Client, ListsScenes) {
  FakeServer server(replying([](const v1::Envelope& request, v1::Envelope& reply) {
    if (!request.has_scene_list()) return;
    reply.mutable_scene_list_reply()->add_scenes()->set_name("a");
    reply.mutable_scene_list_reply()->add_scenes()->set_name("b");
  }));
  Client client(at(server), {});
  const std::vector<SceneInfo> scenes = client.scenes({});
  ASSERT_EQ(scenes.size(), 2U);
  EXPECT_EQ(scenes[1].name, "b");
}

TEST(Client, TagsAScene) {
  FakeServer server(replying([](const v1::Envelope& request, v1::Envelope& reply) {
    *reply.mutable_scene_reply()->mutable_scene()->mutable_tags() = request.scene_tag().tags();
  }));
  Client client(at(server), {});
  EXPECT_EQ(client.tag_scene("a", {{"floor", "2"}}, {}).tags.at("floor"), "2");
}

}  // namespace
}  // namespace landmarkdb::client
