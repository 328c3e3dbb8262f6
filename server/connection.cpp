#include "server/connection.hpp"

#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/write.hpp>

namespace landmarkdb {

namespace {

using boost::system::error_code;

// Frames up to this long are not counted against the memory budget: requests without clouds.
constexpr std::size_t kSmallFrameBytes = std::size_t{256} * 1024;

}  // namespace

Connection::Connection(Socket socket, const ConnectionLimits& limits, MemoryBudget& budget)
    : socket_(std::move(socket)),
      limits_(limits),
      budget_(budget),
      reader_(kMaxHelloBytes),
      read_timer_(socket_.get_executor()),
      write_timer_(socket_.get_executor()) {}

void Connection::start_reading() {
  rearm_timer();
  read_some();
}

void Connection::open_up(std::size_t max_message_bytes) {
  greeted_ = true;
  max_message_bytes_ = max_message_bytes;
  reader_.set_limit(max_message_bytes);
}

void Connection::read_some() {
  socket_.async_read_some(
      boost::asio::buffer(read_buffer_),
      bound([this](const error_code& error, std::size_t bytes) { on_read(error, bytes); }));
}

// Reading goes on until the peer ends or the socket is closed; what comes after the connection has
// been given up is thrown away.
void Connection::on_read(const error_code& error, std::size_t bytes) {
  if (phase_ == Phase::kClosed) return;
  if (error) {
    input_ended_ = true;
    if (error != boost::asio::error::eof || phase_ == Phase::kLingering) {
      cut(error == boost::asio::error::eof ? "" : error.message());
    } else if (phase_ == Phase::kOpen) {
      on_input_end();
    }
    return;
  }
  if (phase_ == Phase::kOpen) {
    last_active_ = Clock::now();
    if (!reader_.in_frame()) frame_start_ = last_active_;
    reader_.feed(std::string_view(read_buffer_.data(), bytes));
    take_frames();
    rearm_timer();
  }
  if (phase_ != Phase::kClosed) read_some();
}

void Connection::take_frames() {
  while (phase_ == Phase::kOpen) {
    const Frame frame = reader_.next();
    switch (frame.status) {
      case FrameStatus::kNeedMore:
        if (!reserve_memory(frame.announced_bytes)) {
          broken(ErrorCode::kResourceExhausted,
                 "the server has no memory left for a message of " +
                     std::to_string(frame.announced_bytes) + " bytes; try again later");
        }
        return;
      case FrameStatus::kFrame:
        frame_start_ = last_active_;  // of the one after it
        if (!reserve_memory(frame.payload.size())) {
          broken(ErrorCode::kResourceExhausted, "the server has no memory left for this message");
          return;
        }
        on_frame(frame.payload, std::exchange(frame_memory_, {}));
        break;
      case FrameStatus::kTooLong:
        broken(ErrorCode::kResourceExhausted,
               "a message of " + std::to_string(frame.announced_bytes) +
                   " bytes is announced, the limit is " + std::to_string(max_message_bytes_) +
                   (greeted_ ? " (--max-message)" : " before Hello is done"));
        return;
      case FrameStatus::kEmpty:
        broken(ErrorCode::kInvalidArgument, "a message of 0 bytes is announced, want at least one");
        return;
    }
  }
}

bool Connection::reserve_memory(std::size_t announced_bytes) {
  if (announced_bytes <= kSmallFrameBytes || frame_memory_) return true;
  frame_memory_ = budget_.reserve(announced_bytes);
  return static_cast<bool>(frame_memory_);
}

void Connection::broken(ErrorCode code, const std::string& message) {
  on_broken(code, message);
  close_after_sending();
}

// One timer, set to whatever comes first: the end of the handshake, of a frame, of patience.
void Connection::rearm_timer() {
  if (phase_ != Phase::kOpen) return;
  Clock::time_point until;
  if (!greeted_) {
    until = started_ + limits_.hello_timeout;
  } else if (reader_.in_frame() && !input_ended_) {
    // Time is earned by bytes that came, not by bytes announced.
    const std::chrono::duration<double> transfer(static_cast<double>(reader_.buffered_bytes()) /
                                                 static_cast<double>(limits_.min_bytes_per_s));
    until = frame_start_ + limits_.frame_timeout +
            std::chrono::duration_cast<Clock::duration>(transfer);
  } else {
    until = (busy() || sending() ? Clock::now() : last_active_) + limits_.idle_timeout;
  }
  read_timer_.expires_at(until);
  read_timer_.async_wait(bound([this](const error_code& error) {
    if (!error && read_timer_.expiry() <= Clock::now()) on_timer();
  }));
}

void Connection::on_timer() {
  if (phase_ != Phase::kOpen) return;
  if (!greeted_) {
    broken(ErrorCode::kDeadlineExceeded, "no Hello came in time");
  } else if (reader_.in_frame() && !input_ended_) {
    broken(ErrorCode::kDeadlineExceeded, "the message came too slowly");
  } else if (busy() || sending()) {
    rearm_timer();
  } else {
    on_idle();
  }
}

void Connection::send_frame(std::string frame) {
  if (phase_ != Phase::kOpen) return;
  // One answer alone may be longer.
  if (!outbox_.empty() && outbox_bytes_ + frame.size() > limits_.max_outbox_bytes) {
    cut("the client does not read its answers");
    return;
  }
  last_active_ = Clock::now();
  outbox_bytes_ += frame.size();
  outbox_.push_back(std::move(frame));
  if (outbox_.size() == 1) write_front();
}

void Connection::write_front() {
  const std::chrono::duration<double> transfer(static_cast<double>(outbox_.front().size()) /
                                               static_cast<double>(limits_.min_bytes_per_s));
  write_timer_.expires_after(limits_.write_timeout +
                             std::chrono::duration_cast<Clock::duration>(transfer));
  write_timer_.async_wait(bound([this](const error_code& error) {
    if (!error && write_timer_.expiry() <= Clock::now()) {
      cut("the client takes its answer too slowly");
    }
  }));
  boost::asio::async_write(socket_,
                           boost::asio::buffer(outbox_.front()),
                           bound([this](const error_code& error, std::size_t) {
                             if (phase_ == Phase::kClosed) return;
                             write_timer_.cancel();
                             if (error) {
                               cut(error.message());
                               return;
                             }
                             outbox_bytes_ -= outbox_.front().size();
                             outbox_.pop_front();
                             if (!outbox_.empty()) {
                               write_front();
                             } else if (phase_ == Phase::kFlushing) {
                               linger();
                             }
                           }));
}

void Connection::close_after_sending() {
  if (phase_ != Phase::kOpen) return;
  phase_ = Phase::kFlushing;
  read_timer_.cancel();
  frame_memory_ = {};
  if (outbox_.empty()) linger();
}

// Closing a TCP socket that holds unread bytes resets it, and the peer may then never see what was
// sent last: so say that this side is done, and read on for a moment.
void Connection::linger() {
  phase_ = Phase::kLingering;
  error_code error;
  socket_.shutdown(Socket::shutdown_send, error);
  if (error || input_ended_) {
    cut();
    return;
  }
  read_timer_.expires_after(limits_.linger);
  read_timer_.async_wait(bound([this](const error_code& cancelled) {
    if (!cancelled) cut();
  }));
}

void Connection::cut(std::string why) {
  if (phase_ == Phase::kClosed) return;
  phase_ = Phase::kClosed;
  error_code ignored;
  socket_.close(ignored);
  read_timer_.cancel();
  write_timer_.cancel();
  frame_memory_ = {};
  on_closed(why);
}

}  // namespace landmarkdb
