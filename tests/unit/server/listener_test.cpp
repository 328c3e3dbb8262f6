#include "server/listener.hpp"

#include <algorithm>
#include <fstream>
#include <thread>
#include <vector>

#include <boost/asio/ip/tcp.hpp>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "engine/base/error.hpp"
#include "tests/unit/server/server_support.hpp"

namespace landmarkdb {
namespace {

using landmarkdb::testing::TemporaryFolder;
using landmarkdb::testing::TestClient;
using ::testing::HasSubstr;

class ListenerTest : public ::testing::Test {
 protected:
  static Error refusal(const std::function<void()>& listen) {
    try {
      listen();
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "it listens";
    return {ErrorCode::kUnknown, ""};
  }

  boost::asio::io_context io;
  Strand strand = boost::asio::make_strand(io);
  TemporaryFolder folder;
};

TEST(ParseHostPort, TakesHostsNumbersAndBracketedAddresses) {
  EXPECT_EQ(parse_host_port("127.0.0.1:7071").port, "7071");
  EXPECT_EQ(parse_host_port("localhost:0").host, "localhost");
  EXPECT_EQ(parse_host_port("[::1]:80").host, "::1");
  for (const char* bad : {"",
                          "7071",
                          ":7071",
                          "host:",
                          "host:http",
                          "host:65536",
                          "::1:80",
                          "host:-1",
                          "[]:80",
                          "host:7071 "}) {
    EXPECT_THROW(parse_host_port(bad), Error) << bad;
  }
}

TEST_F(ListenerTest, TakesAFreePortAndSaysWhich) {
  const auto listener = listen_tcp(strand, "127.0.0.1:0", false);
  EXPECT_GT(listener->port(), 0);
  EXPECT_EQ(listener->address(), "127.0.0.1:" + std::to_string(listener->port()));
}

TEST_F(ListenerTest, NamesABusyPort) {
  const auto first = listen_tcp(strand, "127.0.0.1:0", false);
  const Error error = refusal([&] { listen_tcp(strand, first->address(), false); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr(first->address()));
}

TEST_F(ListenerTest, RefusesAnAddressOthersCanReachUnlessAllowed) {
  EXPECT_EQ(refusal([&] { listen_tcp(strand, "0.0.0.0:0", false); }).code(),
            ErrorCode::kPermissionDenied);
  EXPECT_GT(listen_tcp(strand, "0.0.0.0:0", true)->port(), 0);
}

TEST_F(ListenerTest, KeepsAUnixSocketToItsUserAndRemovesItAtTheEnd) {
  const std::string path = folder.file("a.sock");
  const auto listener = listen_unix(strand, path);
  struct stat info {};
  ASSERT_EQ(::stat(path.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
  EXPECT_EQ(listener->address(), "unix:" + path);
  listener->close();
  EXPECT_NE(::stat(path.c_str(), &info), 0);
}

TEST_F(ListenerTest, ReplacesASocketNobodyAnswersOn) {
  const std::string path = folder.file("a.sock");
  { const auto abandoned = listen_unix(strand, path); }  // not closed: the file stays
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_NO_THROW(listen_unix(strand, path));
}

TEST_F(ListenerTest, LeavesASocketAloneThatIsAnswered) {
  const std::string path = folder.file("a.sock");
  const auto first = listen_unix(strand, path);
  EXPECT_EQ(refusal([&] { listen_unix(strand, path); }).code(), ErrorCode::kUnavailable);
  EXPECT_NO_THROW(TestClient::unix_socket(path));
}

// Two that find the same abandoned file: each might remove what the other has just made.
TEST_F(ListenerTest, GivesAnAbandonedPathToOneOfManyThatStartAtOnce) {
  for (int round = 0; round < 20; ++round) {
    const std::string path = folder.file("race" + std::to_string(round));
    { const auto abandoned = listen_unix(strand, path); }
    std::vector<std::unique_ptr<Listener>> listeners(4);
    {
      std::vector<std::jthread> threads;
      for (auto& listener : listeners) {
        threads.emplace_back([&] {
          try {
            listener = listen_unix(strand, path);
          } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::kUnavailable) << error.what();
          }
        });
      }
    }
    EXPECT_EQ(std::ranges::count_if(listeners, [](const auto& one) { return one != nullptr; }), 1);
    EXPECT_NO_THROW(TestClient::unix_socket(path));
  }
}

TEST_F(ListenerTest, LeavesTheFileOfAnotherThatTookItsPathAlone) {
  const std::string path = folder.file("a.sock");
  const auto first = listen_unix(strand, path);
  std::filesystem::remove(path);  // by hand
  const auto second = listen_unix(strand, path);
  first->close();
  EXPECT_NO_THROW(TestClient::unix_socket(path));
}

TEST_F(ListenerTest, LeavesNothingBesideTheSocket) {
  const auto listener = listen_unix(strand, folder.file("a.sock"));
  listener->close();
  EXPECT_TRUE(
      std::filesystem::is_empty(std::filesystem::path(folder.file("a.sock")).parent_path()));
}

TEST_F(ListenerTest, LeavesAFileAloneThatIsNoSocket) {
  const std::string path = folder.file("notes.txt");
  std::ofstream(path) << "keep me";
  EXPECT_EQ(refusal([&] { listen_unix(strand, path); }).code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(landmarkdb::testing::bytes_of_file(path), "keep me");
}

TEST_F(ListenerTest, RefusesAPathThatIsTooLongForASocket) {
  EXPECT_EQ(refusal([&] { listen_unix(strand, folder.file(std::string(120, 'x'))); }).code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace landmarkdb
