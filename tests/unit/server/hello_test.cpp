#include "server/hello.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::hello_envelope;
using ::testing::HasSubstr;

v1::Envelope answer(const v1::Envelope& first, const ServerOptions& options = {}) {
  const ServerState state("nowhere.db");
  return answer_hello(first, options, state);
}

TEST(AnswerHello, NamesVersionsAndLimits) {
  ServerOptions options;
  options.read_only = true;
  const v1::Envelope reply = answer(hello_envelope(), options);
  ASSERT_TRUE(reply.has_hello_reply());
  EXPECT_EQ(reply.hello_reply().protocol_major(), kProtocolMajor);
  EXPECT_EQ(reply.hello_reply().max_message_bytes(), kDefaultMaxMessageBytes);
  EXPECT_FALSE(reply.hello_reply().server_version().empty());
  EXPECT_THAT(reply.hello_reply().features(), ::testing::Contains("read_only"));
}

TEST(AnswerHello, TakesALaterMinorVersion) {
  v1::Envelope hello = hello_envelope();
  hello.mutable_hello()->set_protocol_minor(99);
  EXPECT_TRUE(answer(hello).has_hello_reply());
}

TEST(AnswerHello, RefusesAnotherMajorVersionAndSaysWhichSideIsOld) {
  v1::Envelope hello = hello_envelope();
  hello.mutable_hello()->set_protocol_major(kProtocolMajor + 1);
  EXPECT_EQ(answer(hello).error().code(), v1::CODE_UNIMPLEMENTED);
  EXPECT_THAT(answer(hello).error().message(), HasSubstr("the server is too old"));
  hello.mutable_hello()->set_protocol_major(0);
  EXPECT_THAT(answer(hello).error().message(), HasSubstr("the client is too old"));
}

TEST(AnswerHello, RefusesAnyOtherFirstMessage) {
  v1::Envelope health;
  health.mutable_health();
  EXPECT_EQ(answer(health).error().code(), v1::CODE_FAILED_PRECONDITION);
}

TEST(AnswerHello, WantsTheToken) {
  ServerOptions options;
  options.token = "sesame";
  EXPECT_EQ(answer(hello_envelope(), options).error().code(), v1::CODE_UNAUTHENTICATED);
  EXPECT_EQ(answer(hello_envelope("sesamE"), options).error().code(), v1::CODE_UNAUTHENTICATED);
  EXPECT_EQ(answer(hello_envelope("sesame "), options).error().code(), v1::CODE_UNAUTHENTICATED);
  EXPECT_TRUE(answer(hello_envelope("sesame"), options).has_hello_reply());
}

TEST(SameSecret, ComparesLengthAndContent) {
  EXPECT_TRUE(same_secret("", ""));
  EXPECT_TRUE(same_secret("abc", "abc"));
  EXPECT_FALSE(same_secret("abcabc", "abc"));
  EXPECT_FALSE(same_secret("ab", "abc"));
  EXPECT_FALSE(same_secret("a", ""));
}

TEST(ReadTokenFile, TakesTheFirstLineWithoutBlanks) {
  const landmarkdb::testing::TemporaryFolder folder;
  const std::string path = folder.file("token");
  std::ofstream(path) << "  open sesame \r\nnot this\n";
  EXPECT_EQ(read_token_file(path), "open sesame");
  std::ofstream(path) << "\nlater\n";
  EXPECT_THROW(read_token_file(path), Error);
  std::ofstream(path) << "";
  EXPECT_THROW(read_token_file(path), Error);
  EXPECT_THROW(read_token_file(folder.file("missing")), Error);
}

}  // namespace
}  // namespace landmarkdb
