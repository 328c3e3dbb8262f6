#include "server/session.hpp"

#include <thread>

#include <gmock/gmock.h>

#include "engine/base/random.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::hello_envelope;
using landmarkdb::testing::make_blob;
using landmarkdb::testing::make_view;
using landmarkdb::testing::query_envelope;
using landmarkdb::testing::RunningServer;
using landmarkdb::testing::TestClient;
using ::testing::HasSubstr;
using namespace std::chrono_literals;

v1::Envelope health_envelope(std::uint64_t request_id) {
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  envelope.mutable_health();
  return envelope;
}

// The server still answers somebody else.
void expect_others_unharmed(RunningServer& running) {
  TestClient other = running.client();
  EXPECT_TRUE(other.call(health_envelope(1)).health_reply().ready());
}

TEST(Session, AnswersAQueryAfterHello) {
  RunningServer running;
  TestClient client = running.client();
  const v1::Envelope reply = client.call(query_envelope(3, make_view()));
  ASSERT_TRUE(reply.has_query_result()) << reply.DebugString();
  running.server.reset();  // writes no more
  EXPECT_THAT(running.log_text.str(), HasSubstr("query connection="));
  EXPECT_THAT(running.log_text.str(), HasSubstr("verdict="));
}

TEST(Session, WantsHelloFirst) {
  RunningServer running;
  TestClient client = TestClient::tcp(running.server->port());
  EXPECT_EQ(client.call(health_envelope(1)).error().code(), v1::CODE_FAILED_PRECONDITION);
  EXPECT_TRUE(client.closed_by_server());
}

TEST(Session, RefusesAnotherProtocolAndCloses) {
  RunningServer running;
  TestClient client = TestClient::tcp(running.server->port());
  v1::Envelope hello = hello_envelope();
  hello.mutable_hello()->set_protocol_major(77);
  EXPECT_EQ(client.call(hello).error().code(), v1::CODE_UNIMPLEMENTED);
  EXPECT_TRUE(client.closed_by_server());
}

TEST(Session, RefusesAWrongTokenAndCloses) {
  RunningServer running({.token = "sesame"});
  TestClient stranger = TestClient::tcp(running.server->port());
  EXPECT_EQ(stranger.hello("guess").error().code(), v1::CODE_UNAUTHENTICATED);
  EXPECT_TRUE(stranger.closed_by_server());
  TestClient friendly = TestClient::tcp(running.server->port());
  EXPECT_TRUE(friendly.hello("sesame").has_hello_reply());
  running.server.reset();
  EXPECT_THAT(running.log_text.str(), ::testing::Not(HasSubstr("guess")));
}

TEST(Session, AnswersASecondHelloWithAnErrorAndGoesOn) {
  RunningServer running;
  TestClient client = running.client();
  EXPECT_EQ(client.hello().error().code(), v1::CODE_FAILED_PRECONDITION);
  EXPECT_TRUE(client.call(health_envelope(1)).has_health_reply());
}

TEST(Session, AnswersRequestsSentAllAtOnce) {
  RunningServer running;
  TestClient client = running.client();
  std::string bytes;
  for (std::uint64_t id = 1; id <= 20; ++id) {
    bytes += encode_frame(health_envelope(id).SerializeAsString());
  }
  bytes += encode_frame(query_envelope(21, make_blob()).SerializeAsString());
  client.send_bytes(bytes);
  for (std::uint64_t id = 1; id <= 20; ++id) {
    EXPECT_TRUE(client.answer_to(id).has_health_reply());
  }
  EXPECT_TRUE(client.answer_to(21).has_query_result());
}

TEST(Session, AnswersPingAndLightRequestsWhileQueriesRun) {
  RunningServer running({.threads = 1});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 5; ++id) client.send(query_envelope(id, make_view()));
  v1::Envelope ping;
  ping.set_request_id(100);
  ping.mutable_ping()->set_value(5);
  client.send(ping);
  bool all_queries_answered = false;
  int queries = 0;
  for (int i = 0; i < 6;) {
    const v1::Envelope message = client.receive().value();
    if (message.has_progress()) continue;
    ++i;
    if (message.has_query_result()) ++queries;
    if (message.has_pong()) {
      EXPECT_EQ(message.pong().value(), 5U);
      all_queries_answered = queries == 5;
    }
  }
  EXPECT_FALSE(all_queries_answered) << "the ping waited for five queries";
}

TEST(Session, TakesFramesInSmallPieces) {
  RunningServer running;
  TestClient client = TestClient::tcp(running.server->port());
  for (const char byte : encode_frame(hello_envelope().SerializeAsString())) {
    client.send_bytes(std::string_view(&byte, 1));
  }
  EXPECT_TRUE(client.answer_to(hello_envelope().request_id()).has_hello_reply());
}

TEST(Session, RefusesALongFrameBeforeHello) {
  RunningServer running;
  TestClient client = TestClient::tcp(running.server->port());
  client.send_bytes(encode_frame(std::string(kMaxHelloBytes + 1, 'x')));
  EXPECT_EQ(client.receive()->error().code(), v1::CODE_RESOURCE_EXHAUSTED);
  EXPECT_TRUE(client.closed_by_server());
  expect_others_unharmed(running);
}

TEST(Session, RefusesAFrameOverTheLimitFromItsLengthAlone) {
  RunningServer running({.max_message_bytes = 1 << 20});
  TestClient client = running.client();
  client.send_bytes(std::string("\x7f\xff\xff\xff", 4));
  const v1::Envelope reply = client.receive().value();
  EXPECT_EQ(reply.error().code(), v1::CODE_RESOURCE_EXHAUSTED);
  EXPECT_THAT(reply.error().message(), HasSubstr("1048576"));
  EXPECT_TRUE(client.closed_by_server());
  expect_others_unharmed(running);
}

TEST(Session, RefusesBytesThatAreNoEnvelope) {
  RunningServer running;
  for (const std::string& bytes : {encode_frame("\xff\xff\xff\xff garbage"),
                                   encode_frame(""),
                                   std::string("GET / HTTP/1.1\r\n\r\n")}) {
    TestClient client = TestClient::tcp(running.server->port());
    client.send_bytes(bytes);
    EXPECT_TRUE(client.receive()->has_error());
    EXPECT_TRUE(client.closed_by_server());
    TestClient greeted = running.client();
    greeted.send_bytes(bytes);
    EXPECT_TRUE(greeted.receive()->has_error());
    EXPECT_TRUE(greeted.closed_by_server());
  }
  expect_others_unharmed(running);
}

TEST(Session, SurvivesMutatedConversations) {
  RunningServer running;
  Random random(17);
  const std::string good =
      encode_frame(hello_envelope().SerializeAsString()) +
      encode_frame(health_envelope(1).SerializeAsString()) +
      encode_frame(query_envelope(2, make_blob()).SerializeAsString().substr(0, 300));
  for (int round = 0; round < 60; ++round) {
    std::string bytes = good.substr(0, random.below(good.size() + 1));
    for (std::uint64_t edits = random.below(4); edits > 0 && !bytes.empty(); --edits) {
      bytes[random.below(bytes.size())] = static_cast<char>(random.below(256));
    }
    TestClient client = TestClient::tcp(running.server->port());
    client.send_bytes(bytes);
    client.end_sending();
    EXPECT_TRUE(client.closed_by_server()) << "round " << round;
  }
  expect_others_unharmed(running);
}

TEST(Session, ClosesWhoDoesNotSayHelloInTime) {
  ServerOptions options;
  options.connection.hello_timeout = 100ms;
  RunningServer running(options);
  TestClient silent = TestClient::tcp(running.server->port());
  EXPECT_EQ(silent.receive()->error().code(), v1::CODE_DEADLINE_EXCEEDED);
  EXPECT_TRUE(silent.closed_by_server());
}

TEST(Session, ClosesASenderThatIsTooSlow) {
  ServerOptions options;
  options.connection.frame_timeout = 200ms;
  RunningServer running(options);
  TestClient slow = running.client();
  std::atomic<bool> done{false};
  // Bytes keep coming, far too few: activity alone must not keep a frame open.
  std::thread trickle([&] {
    slow.send_bytes(std::string("\0\0\x10\0", 4));
    while (!done) {
      slow.send_bytes("x");
      std::this_thread::sleep_for(20ms);
    }
  });
  EXPECT_EQ(slow.receive()->error().code(), v1::CODE_DEADLINE_EXCEEDED);
  done = true;
  trickle.join();
  EXPECT_TRUE(slow.closed_by_server());
  expect_others_unharmed(running);
}

TEST(Session, SaysGoAwayToTheIdle) {
  ServerOptions options;
  options.connection.idle_timeout = 300ms;
  RunningServer running(options);
  TestClient idle = running.client();
  EXPECT_TRUE(idle.receive()->has_go_away());
  EXPECT_TRUE(idle.closed_by_server());
}

// A killed process ends its sending just so; its queries used to be computed to their end.
TEST(Session, StopsTheRequestsOfAClientThatHasEndedItsSending) {
  RunningServer running({.threads = 1});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 20; ++id) client.send(query_envelope(id, make_view()));
  client.end_sending();
  EXPECT_TRUE(client.closed_by_server());
  TestClient other = running.client();
  EXPECT_TRUE(other.call(query_envelope(1, make_blob())).has_query_result())
      << "the line is free: those before were thrown away";
  running.server.reset();
  EXPECT_THAT(running.log_text.str(), HasSubstr("error=CANCELLED"));
}

TEST(Session, SendsWhatWasReadyToAClientThatHasEndedItsSending) {
  RunningServer running;
  TestClient client = running.client();
  client.send(health_envelope(1));
  client.end_sending();
  EXPECT_TRUE(client.answer_to(1).has_health_reply());
  EXPECT_TRUE(client.closed_by_server());
}

TEST(Session, CancelsARequestThatWaits) {
  RunningServer running({.threads = 1});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 8; ++id) client.send(query_envelope(id, make_view()));
  v1::Envelope cancel;
  cancel.set_request_id(8);
  cancel.mutable_cancel();
  client.send(cancel);
  EXPECT_EQ(client.answer_to(8).error().code(), v1::CODE_CANCELLED);
  cancel.set_request_id(4711);  // never asked for: nothing happens
  client.send(cancel);
  EXPECT_TRUE(client.call(health_envelope(9)).has_health_reply());
}

TEST(Session, KeepsTheDeadlineOfARequestThatWaits) {
  RunningServer running({.threads = 1});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 8; ++id) client.send(query_envelope(id, make_view()));
  v1::Envelope late = query_envelope(9, make_view());
  late.set_timeout_ms(1);
  EXPECT_EQ(client.call(late).error().code(), v1::CODE_DEADLINE_EXCEEDED);
}

TEST(Session, HoldsTheServersOwnDeadlineAgainstALongerOne) {
  RunningServer running({.deadline = 1ms});
  TestClient client = running.client();
  v1::Envelope query = query_envelope(1, make_view());
  query.set_timeout_ms(3'600'000);
  EXPECT_EQ(client.call(query).error().code(), v1::CODE_DEADLINE_EXCEEDED);
}

TEST(Session, TurnsRequestsAwayWhenTooManyWait) {
  RunningServer running({.threads = 1, .max_waiting_queries = 2});
  TestClient client = running.client();
  for (std::uint64_t id = 1; id <= 12; ++id) client.send(query_envelope(id, make_view()));
  int turned_away = 0;
  int answered = 0;
  while (turned_away + answered < 12) {
    const v1::Envelope message = client.receive().value();
    if (message.has_query_result()) ++answered;
    if (!message.has_error()) continue;
    EXPECT_EQ(message.error().code(), v1::CODE_RESOURCE_EXHAUSTED);
    EXPECT_GT(message.error().retry_after_ms(), 0U);
    ++turned_away;
  }
  EXPECT_GT(turned_away, 0);
  EXPECT_GE(answered, 3);
}

TEST(Session, RefusesANumberThatIsTakenOrMissing) {
  RunningServer running({.threads = 1});
  TestClient client = running.client();
  client.send(health_envelope(0));
  EXPECT_EQ(client.receive()->error().field(), "request_id");
  client.send(query_envelope(1, make_view()));
  client.send(query_envelope(1, make_view()));
  std::optional<v1::Envelope> message;
  do {
    message = client.receive();
  } while (message && !message->has_error());
  ASSERT_TRUE(message.has_value());
  EXPECT_THAT(message->error().message(), HasSubstr("is taken"));
  EXPECT_TRUE(client.closed_by_server());
}

TEST(Session, CutsOffAReaderThatDoesNotRead) {
  ServerOptions options;
  options.connection.max_outbox_bytes = 100'000;
  options.connection.max_open_requests = 1'000'000;
  RunningServer running(options);
  TestClient client = running.client();
  std::string bytes;
  for (std::uint64_t id = 1; id <= 40; ++id) {
    bytes += encode_frame(health_envelope(id).SerializeAsString());
  }
  for (int i = 0; i < 20'000; ++i) client.send_bytes(bytes);
  EXPECT_TRUE(client.closed_by_server());
  expect_others_unharmed(running);
  running.server.reset();
  EXPECT_THAT(running.log_text.str(), HasSubstr("does not read its answers"));
}

}  // namespace
}  // namespace landmarkdb
