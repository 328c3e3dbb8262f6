#include "server/connection.hpp"

#include <stdexcept>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/connect_pair.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <gtest/gtest.h>

namespace landmarkdb {
namespace {

using boost::asio::local::stream_protocol;

// Fails on the frame "throw", counts the others.
class Fragile final : public Connection {
 public:
  using Connection::Connection;
  int frames = 0;
  int input_ends = 0;
  std::optional<std::string> why_closed;

 private:
  void on_frame(std::string_view payload, MemoryBudget::Lease) override {
    if (payload == "throw") throw std::runtime_error("no luck");
    ++frames;
  }
  void on_broken(ErrorCode, const std::string&) override {}
  void on_input_end() override {
    ++input_ends;
    close_after_sending();
  }
  void on_idle() override {}
  void on_closed(const std::string& why) override { why_closed = why; }
  bool busy() const override { return false; }
};

class ConnectionTest : public ::testing::Test {
 protected:
  std::shared_ptr<Fragile> connect(stream_protocol::socket& peer) {
    stream_protocol::socket socket(io);
    boost::asio::local::connect_pair(socket, peer);
    auto connection =
        std::make_shared<Fragile>(Connection::Socket(std::move(socket)), limits, budget);
    connection->start_reading();
    return connection;
  }

  boost::asio::io_context io;
  ConnectionLimits limits;
  MemoryBudget budget{1'000'000};
};

// An exception on a socket thread used to end the server.
TEST_F(ConnectionTest, EndsItselfAloneWhenItsHandlerThrows) {
  stream_protocol::socket bad(io), good(io);
  const auto broken = connect(bad);
  const auto other = connect(good);
  boost::asio::write(bad, boost::asio::buffer(encode_frame("throw")));
  boost::asio::write(good, boost::asio::buffer(encode_frame("fine")));
  good.close();
  ASSERT_NO_THROW(io.run());
  EXPECT_EQ(broken->why_closed, "an error of the server itself: no luck");
  EXPECT_EQ(other->frames, 1);
  EXPECT_EQ(other->why_closed, "");
}

TEST_F(ConnectionTest, TellsOnceThatItsPeerSendsNoMoreAndStillSends) {
  stream_protocol::socket peer(io);
  const auto connection = connect(peer);
  connection->send_frame(encode_frame("last words"));
  peer.shutdown(stream_protocol::socket::shutdown_send);
  io.run();
  EXPECT_EQ(connection->input_ends, 1);
  EXPECT_EQ(connection->why_closed, "");
  std::string got(encode_frame("last words").size(), '\0');
  boost::system::error_code error;
  boost::asio::read(peer, boost::asio::buffer(got), error);
  EXPECT_EQ(got, encode_frame("last words"));
}

// Replies and Progress count alike: whatever waits for the peer.
TEST_F(ConnectionTest, CutsAPeerThatLeavesMoreWaitingThanTheLimit) {
  limits.max_outbox_bytes = 1'000'000;
  stream_protocol::socket peer(io);
  const auto connection = connect(peer);
  connection->send_frame(std::string(3'000'000, 'x'));
  EXPECT_FALSE(connection->why_closed) << "one alone may be longer than the limit";
  connection->send_frame("x");
  EXPECT_EQ(connection->why_closed, "the client does not read its answers");
}

}  // namespace
}  // namespace landmarkdb
