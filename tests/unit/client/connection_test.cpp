#include "client/connection.hpp"

#include <atomic>
#include <chrono>
#include <thread>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/client/fake_server.hpp"

namespace landmarkdb::client {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using testing::FakePeer;
using testing::FakeServer;
using ::testing::HasSubstr;

ConnectOptions options_for(const FakeServer& server) {
  ConnectOptions options;
  options.server = server.address();
  options.token = "secret";
  return options;
}

v1::Envelope stats_request() {
  v1::Envelope request;
  request.mutable_stats();
  return request;
}

// Runs `action` and hands back the Error it must throw.
template <typename Action>
Error error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::kUnknown, "");
}

TEST(Connection, GreetsWithVersionAndTokenAndCarriesAnAnswer) {
  std::optional<v1::Envelope> hello;
  FakeServer server([&hello](FakePeer& peer) {
    hello = peer.receive();
    v1::Envelope greeting;
    greeting.mutable_hello_reply()->set_protocol_major(kProtocolMajor);
    peer.send(greeting);
    const std::optional<v1::Envelope> request = peer.receive();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_stats_reply()->set_scenes(7);
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  EXPECT_EQ(connection.call(stats_request(), {}).stats_reply().scenes(), 7U);
  ASSERT_TRUE(hello && hello->has_hello());
  EXPECT_EQ(hello->hello().protocol_major(), kProtocolMajor);
  EXPECT_EQ(hello->hello().token(), "secret");
}

TEST(Connection, RefusesAServerOfAnotherMajorVersion) {
  FakeServer server([](FakePeer& peer) {
    peer.receive();
    v1::Envelope greeting;
    greeting.mutable_hello_reply()->set_protocol_major(kProtocolMajor + 1);
    peer.send(greeting);
  });
  const Error error = error_of([&] { Connection(options_for(server), {}); });
  EXPECT_EQ(exit_status(error.code()), 6);
  EXPECT_THAT(error.what(), AllOf(HasSubstr("protocol 2.0"), HasSubstr("speaks 1.0")));
}

TEST(Connection, PassesOnWhyTheGreetingWasRefused) {
  FakeServer server([](FakePeer& peer) {
    peer.receive();
    v1::Envelope refusal;
    refusal.mutable_error()->set_code(v1::CODE_UNAUTHENTICATED);
    refusal.mutable_error()->set_message("the token is not known");
    peer.send(refusal);
  });
  const Error error = error_of([&] { Connection(options_for(server), {}); });
  EXPECT_EQ(exit_status(error.code()), 9);
  EXPECT_STREQ(error.what(), "the token is not known");
}

TEST(Connection, SaysThatAnotherProgramAnswers) {
  FakeServer web([](FakePeer& peer) {
    peer.receive();
    peer.send_bytes("HTTP/1.1 400 Bad Request\r\n\r\n");
  });
  const Error too_long = error_of([&] { Connection(options_for(web), {}); });
  EXPECT_EQ(exit_status(too_long.code()), 8);
  EXPECT_THAT(too_long.what(), HasSubstr("does not speak landmarkdb's protocol"));

  FakeServer noise([](FakePeer& peer) {
    peer.receive();
    peer.send_bytes(encode_frame("\xff\xff\xff\xff no message"));
  });
  const Error garbage = error_of([&] { Connection(options_for(noise), {}); });
  EXPECT_EQ(exit_status(garbage.code()), 8);
}

TEST(Connection, GivesUpOnAServerThatDoesNotGreet) {
  FakeServer server([](FakePeer& peer) {
    while (peer.receive()) {
    }
  });
  ConnectOptions options = options_for(server);
  options.connect_timeout = 60ms;
  const Error error = error_of([&] { Connection(options, {}); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr("did not answer the greeting"));
}

TEST(Connection, ReportsAServerThatDiesInMidRequest) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    peer.receive();
    peer.send_bytes(std::string("\0\0\1\0half", 8));  // 256 bytes announced, 4 come
  });
  Connection connection(options_for(server), {});
  const Error error = error_of([&] { connection.call(stats_request(), {}); });
  EXPECT_EQ(exit_status(error.code()), 8);
  EXPECT_THAT(error.what(), HasSubstr("closed the connection before it answered"));
}

TEST(Connection, TellsTheReasonOfAGoAway) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    peer.receive();
    v1::Envelope farewell;
    farewell.mutable_go_away()->set_reason("the server is stopping");
    peer.send(farewell);
  });
  Connection connection(options_for(server), {});
  const Error error = error_of([&] { connection.call(stats_request(), {}); });
  EXPECT_THAT(error.what(), HasSubstr("the server is stopping"));
}

TEST(Connection, RefusesAReplyPastTheLimitBeforeItHasArrived) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    peer.receive();
    peer.send_bytes(std::string("\x7f\0\0\0", 4));
    peer.receive();
  });
  Connection connection(options_for(server), {});
  const Error error = error_of([&] { connection.call(stats_request(), {}); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr("2130706432 bytes"));
}

TEST(Connection, RefusesARequestLongerThanTheServerTakes) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    peer.receive();
  });
  Connection connection(options_for(server), {});
  v1::Envelope request;
  request.mutable_query()->add_clouds()->set_xyz(std::string(1'000'001, 'x'));
  const Error error = error_of([&] { connection.call(request, {}); });
  EXPECT_EQ(error.code(), ErrorCode::kResourceExhausted);
  EXPECT_THAT(error.what(), HasSubstr("--max-message"));
}

TEST(Connection, ThrowsAnErrorReplyWithItsCodeAndField) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_error()->set_code(v1::CODE_NOT_FOUND);
    reply.mutable_error()->set_message("no scene 'attic'");
    reply.mutable_error()->set_field("name");
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  const Error error = error_of([&] { connection.call(stats_request(), {}); });
  EXPECT_EQ(error.code(), ErrorCode::kNotFound);
  EXPECT_STREQ(error.what(), "no scene 'attic'");
  EXPECT_EQ(error.field(), "name");
}

TEST(Connection, TakesARequestThatTheServerStoppedForUnavailableNotInterrupted) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_error()->set_code(v1::CODE_CANCELLED);
    reply.mutable_error()->set_message("stopped on request during 'match'");
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  const Error error = error_of([&] { connection.call(stats_request(), {}); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_STREQ(error.what(), "the server gave up: stopped on request during 'match'");
}

TEST(Connection, HandsProgressOnAndSkipsAnswersToOtherRequests) {
  FakeServer server([](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    v1::Envelope other;
    other.set_request_id(request->request_id() + 100);
    other.mutable_stats_reply()->set_scenes(1);
    peer.send(other);
    v1::Envelope progress;
    progress.set_request_id(request->request_id());
    progress.mutable_progress()->set_stage("describe");
    progress.mutable_progress()->set_done(3);
    progress.mutable_progress()->set_total(9);
    peer.send(progress);
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_stats_reply()->set_scenes(2);
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  std::string heard;
  RunContext context;
  context.progress = [&heard](const Progress& p) {
    heard = std::string(p.stage) + " " + std::to_string(p.done) + "/" + std::to_string(p.total);
  };
  EXPECT_EQ(connection.call(stats_request(), context).stats_reply().scenes(), 2U);
  EXPECT_EQ(heard, "describe 3/9");
}

TEST(Connection, AnswersPings) {
  std::atomic<std::uint64_t> value = 0;
  FakeServer server([&value](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    v1::Envelope ping;
    ping.mutable_ping()->set_value(42);
    peer.send(ping);
    value = peer.receive()->pong().value();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_stats_reply();
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  connection.call(stats_request(), {});
  EXPECT_EQ(value, 42U);
}

TEST(Connection, SendsCancelOnAStopRequest) {
  std::atomic<bool> cancelled = false;
  std::stop_source stop;
  FakeServer server([&](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    stop.request_stop();
    const std::optional<v1::Envelope> next = peer.receive();
    cancelled = next && next->has_cancel() && next->request_id() == request->request_id();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_error()->set_code(v1::CODE_CANCELLED);
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  RunContext context;
  context.stop = stop.get_token();
  const Error error = error_of([&] { connection.call(stats_request(), context); });
  EXPECT_EQ(exit_status(error.code()), 130);
  EXPECT_TRUE(cancelled);
}

TEST(Connection, SendsTheDeadlineAlong) {
  std::atomic<std::uint32_t> timeout_ms = 0;
  FakeServer server([&timeout_ms](FakePeer& peer) {
    peer.greet();
    const std::optional<v1::Envelope> request = peer.receive();
    timeout_ms = request->timeout_ms();
    v1::Envelope reply;
    reply.set_request_id(request->request_id());
    reply.mutable_error()->set_code(v1::CODE_DEADLINE_EXCEEDED);
    peer.send(reply);
  });
  Connection connection(options_for(server), {});
  RunContext context;
  context.deadline = std::chrono::steady_clock::now() + 30s;
  const Error error = error_of([&] { connection.call(stats_request(), context); });
  EXPECT_EQ(exit_status(error.code()), 8);
  EXPECT_GT(timeout_ms, 20'000U);
  EXPECT_LE(timeout_ms, 30'000U);
}

}  // namespace
}  // namespace landmarkdb::client
