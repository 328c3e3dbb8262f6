#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <string>
#include <string_view>

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>

#include "engine/base/error.hpp"
#include "proto/framing.hpp"
#include "server/memory_budget.hpp"
#include "server/options.hpp"

namespace landmarkdb {

// One socket that speaks in frames: reading, writing, time limits and an orderly end. What the
// frames mean is left to the class derived from it.
//
// Lives on its strand (the socket's executor): everything here is called there, except the
// constructor. Handlers keep it alive, so it ends by itself once it is closed.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  using Socket = boost::asio::generic::stream_protocol::socket;
  using Clock = std::chrono::steady_clock;

  Connection(Socket socket, const ConnectionLimits& limits, MemoryBudget& budget);
  virtual ~Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Socket::executor_type executor() { return socket_.get_executor(); }

  // Reads until the peer ends or something is wrong.
  void start_reading();
  // Sends a frame. A peer that leaves too many bytes waiting is cut off.
  void send_frame(std::string frame);
  // Lets what is waiting go out, then ends. Nothing more is read but to throw it away.
  void close_after_sending();
  // Ends at once. `why` is for the log; empty where there is nothing to say.
  void cut(std::string why = {});

 protected:
  // A whole frame; the view is valid during the call only. `memory` is held for long frames.
  virtual void on_frame(std::string_view payload, MemoryBudget::Lease memory) = 0;
  // The peer broke a rule of the frames or a time limit; the connection reads no more.
  virtual void on_broken(ErrorCode code, const std::string& message) = 0;
  // The peer will send no more: it is gone, or will not see more than what is on its way already.
  // What waits in the outbox still goes out.
  virtual void on_input_end() = 0;
  // No frames for the idle time.
  virtual void on_idle() = 0;
  // The socket is gone; `why` as told to cut(). Called once.
  virtual void on_closed(const std::string& why) = 0;
  // True while answers are owed: such a connection is not idle.
  virtual bool busy() const = 0;

  // After the handshake: frames may be this long, and the handshake's time limit is over.
  void open_up(std::size_t max_message_bytes);
  // Looks again whether the connection is idle; call when busy() may have become false.
  void rearm_timer();

  bool open() const { return phase_ == Phase::kOpen; }
  bool sending() const { return !outbox_.empty(); }

  // A handler that keeps the connection alive. What it throws (no memory) ends this connection,
  // which could not go on, and nothing else.
  template <typename Handler>
  auto bound(Handler handler) {
    return [self = shared_from_this(), handler = std::move(handler)](auto... arguments) {
      try {
        handler(arguments...);
      } catch (const std::exception& error) {
        self->cut(std::string("an error of the server itself: ") + error.what());
      }
    };
  }

 private:
  enum class Phase { kOpen, kFlushing, kLingering, kClosed };

  void read_some();
  void on_read(const boost::system::error_code& error, std::size_t bytes);
  void take_frames();
  bool reserve_memory(std::size_t announced_bytes);
  void broken(ErrorCode code, const std::string& message);
  void on_timer();
  void write_front();
  void linger();

  Socket socket_;
  const ConnectionLimits& limits_;
  MemoryBudget& budget_;
  FrameReader reader_;
  std::size_t max_message_bytes_ = kMaxHelloBytes;
  std::array<char, 64 * 1024> read_buffer_;

  std::deque<std::string> outbox_;
  std::size_t outbox_bytes_ = 0;

  boost::asio::steady_timer read_timer_;
  boost::asio::steady_timer write_timer_;
  Clock::time_point started_ = Clock::now();
  Clock::time_point last_active_ = Clock::now();
  Clock::time_point frame_start_;
  MemoryBudget::Lease frame_memory_;

  Phase phase_ = Phase::kOpen;
  bool greeted_ = false;  // the handshake is done
  bool input_ended_ = false;
};

}  // namespace landmarkdb
