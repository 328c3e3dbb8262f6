#include "client/socket.hpp"

#include <array>
#include <chrono>

#include <gmock/gmock.h>

#include "engine/base/error.hpp"
#include "tests/unit/client/fake_server.hpp"

namespace landmarkdb::client {
namespace {

using namespace std::chrono_literals;
using testing::FakePeer;
using testing::FakeServer;

ErrorCode code_of_connect(const std::string& address) {
  try {
    Socket(parse_address(address), address, {});
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr(address));
    return error.code();
  }
  return ErrorCode::kUnknown;
}

TEST(Socket, SaysThatNobodyListens) {
  std::string address;
  {
    address = FakeServer([](FakePeer&) {}).address();
  }  // a port that was just given back
  EXPECT_EQ(code_of_connect(address), ErrorCode::kUnavailable);
  EXPECT_EQ(code_of_connect("unix:/nowhere/landmarkdb.sock"), ErrorCode::kUnavailable);
}

TEST(Socket, ReadsWhatThePeerSendsAndSeesItsEnd) {
  FakeServer server([](FakePeer& peer) { peer.send_bytes("abc"); });
  Socket socket(parse_address(server.address()), server.address(), {});
  std::array<char, 8> buffer{};
  const Socket::Read first = socket.receive_some(buffer, {});
  ASSERT_EQ(first.status, Socket::ReadStatus::kBytes);
  EXPECT_EQ(std::string_view(buffer.data(), first.bytes), "abc");
  EXPECT_EQ(socket.receive_some(buffer, {}).status, Socket::ReadStatus::kClosed);
}

TEST(Socket, StopsWaitingAtTheDeadlineAndOnAStopRequest) {
  FakeServer server([](FakePeer& peer) { peer.receive(); });
  Socket socket(parse_address(server.address()), server.address(), {});
  std::array<char, 8> buffer{};
  const WaitLimits past{{}, std::chrono::steady_clock::now() - 1ms};
  EXPECT_EQ(socket.receive_some(buffer, past).status, Socket::ReadStatus::kDeadline);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(socket.receive_some(buffer, {stop.get_token(), {}}).status,
            Socket::ReadStatus::kStopped);
}

}  // namespace
}  // namespace landmarkdb::client
