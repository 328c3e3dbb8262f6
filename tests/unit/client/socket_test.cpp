#include "client/socket.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

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

// A Unix socket whose server accepts nobody, with no room for one more.
class FullBacklog : public ::testing::Test {
 protected:
  FullBacklog() {
    std::string pattern = (std::filesystem::temp_directory_path() / "landmarkdb-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
    const std::string path = folder_ + "/s";
    address_.sun_family = AF_UNIX;
    path.copy(address_.sun_path, sizeof address_.sun_path - 1);
    server_ = ::socket(AF_UNIX, SOCK_STREAM, 0);
    EXPECT_EQ(::bind(server_, reinterpret_cast<const sockaddr*>(&address_), sizeof address_), 0);
    EXPECT_EQ(::listen(server_, 0), 0);
    for (;;) {
      fds_.push_back(::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0));
      if (::connect(fds_.back(), reinterpret_cast<const sockaddr*>(&address_), sizeof address_)) {
        break;
      }
    }
    EXPECT_EQ(errno, EAGAIN);
  }
  ~FullBacklog() override {
    for (const int fd : fds_) ::close(fd);
    ::close(server_);
    std::filesystem::remove_all(folder_);
  }
  std::string address() const { return "unix:" + folder_ + "/s"; }

  std::string folder_;
  sockaddr_un address_{};
  int server_ = -1;
  std::vector<int> fds_;
};

// It used to count as connected.
TEST_F(FullBacklog, IsWaitedForUntilTheDeadlineOrAStopRequest) {
  try {
    Socket(parse_address(address()), address(), {{}, std::chrono::steady_clock::now() + 30ms});
    FAIL() << "connected";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
    EXPECT_THAT(error.what(), ::testing::HasSubstr("within the time allowed"));
  }
  std::stop_source stop;
  stop.request_stop();
  try {
    Socket(parse_address(address()), address(), {stop.get_token(), {}});
    FAIL() << "connected";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kCancelled);
  }
}

TEST_F(FullBacklog, IsConnectedToOnceThereIsRoom) {
  std::vector<int> accepted;
  std::jthread server([&] {
    // Those that fill the backlog, one less than were tried, and then ours.
    while (accepted.size() < fds_.size()) accepted.push_back(::accept(server_, nullptr, nullptr));
    EXPECT_EQ(::send(accepted.back(), "hello", 5, MSG_NOSIGNAL), 5);
  });
  Socket socket(parse_address(address()), address(), {});
  std::array<char, 8> buffer{};
  EXPECT_EQ(socket.receive_some(buffer, {}).bytes, 5U);
  server.join();
  for (const int fd : accepted) ::close(fd);
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
