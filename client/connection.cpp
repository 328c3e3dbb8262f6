#include "client/connection.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "client/convert.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

// After Cancel, and after the deadline, the server gets this long to say so itself.
constexpr milliseconds kCancelPatience{1000};
constexpr std::size_t kReadChunk = std::size_t{64} * 1024;

std::uint32_t left_ms(const RunContext& context) {
  if (!context.deadline) return 0;
  const auto left = std::chrono::ceil<milliseconds>(*context.deadline - steady_clock::now());
  constexpr std::int64_t kMost = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(left.count(), 1, kMost));
}

std::string version_text(std::uint32_t major, std::uint32_t minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

}  // namespace

Connection::Connection(const ConnectOptions& options, const RunContext& context)
    : name_(options.server), reader_(kMaxHelloBytes) {
  WaitLimits limits{context.stop, steady_clock::now() + options.connect_timeout};
  if (context.deadline) limits.deadline = std::min(*limits.deadline, *context.deadline);
  socket_ = std::make_unique<Socket>(parse_address(options.server), name_, limits);
  greet(options, limits);
  reader_.set_limit(options.max_reply_bytes);
}

void Connection::greet(const ConnectOptions& options, const WaitLimits& limits) {
  v1::Envelope request;
  v1::Hello& hello = *request.mutable_hello();
  hello.set_protocol_major(kProtocolMajor);
  hello.set_protocol_minor(kProtocolMinor);
  hello.set_client(options.client);
  hello.set_token(options.token);
  send(request, limits);
  const std::optional<v1::Envelope> reply = receive(limits);
  if (!reply) {
    if (limits.stop.stop_requested()) {
      throw Error(ErrorCode::kCancelled, "interrupted while greeting " + name_);
    }
    throw Error(ErrorCode::kUnavailable,
                name_ + " took the connection but did not answer the greeting in time",
                "--server");
  }
  if (reply->has_error()) throw from_proto(reply->error());
  if (!reply->has_hello_reply()) {
    throw Error(ErrorCode::kUnavailable,
                "what answers at " + name_ + " is no landmarkdb server: no hello came back",
                "--server");
  }
  hello_ = reply->hello_reply();
  if (hello_.protocol_major() != kProtocolMajor) {
    throw Error(ErrorCode::kUnimplemented,
                "the server at " + name_ + " speaks protocol " +
                    version_text(hello_.protocol_major(), hello_.protocol_minor()) +
                    ", this program speaks " + version_text(kProtocolMajor, kProtocolMinor) +
                    ": install programs of the same release");
  }
}

void Connection::send(const v1::Envelope& envelope, const WaitLimits& limits) {
  const std::size_t size = envelope.ByteSizeLong();
  const std::uint64_t limit =
      hello_.max_message_bytes() > 0 ? hello_.max_message_bytes() : kLargestMessageBytes;
  if (size > std::min<std::uint64_t>(limit, kLargestMessageBytes)) {
    throw Error(ErrorCode::kResourceExhausted,
                "the request takes " + std::to_string(size) + " bytes, the server at " + name_ +
                    " takes at most " + std::to_string(limit) +
                    ": thin the cloud, or raise the server's --max-message");
  }
  std::string frame(kFrameHeaderBytes + size, '\0');
  write_frame_header(size, frame.data());
  envelope.SerializeWithCachedSizesToArray(
      reinterpret_cast<std::uint8_t*>(frame.data() + kFrameHeaderBytes));
  if (socket_->send_all(frame, limits)) return;
  // The server has closed its end; what it said before may still lie in our buffer.
  const WaitLimits soon{limits.stop, steady_clock::now() + kCancelPatience};
  while (const std::optional<v1::Envelope> last = receive(soon)) {
    if (last->has_error()) throw from_proto(last->error());
    if (last->has_go_away()) go_away_ = last->go_away().reason();
  }
  lost();
}

std::optional<v1::Envelope> Connection::receive(const WaitLimits& limits) {
  std::array<char, kReadChunk> chunk{};
  for (;;) {
    const Frame frame = reader_.next();
    if (frame.status == FrameStatus::kTooLong || frame.status == FrameStatus::kEmpty) {
      throw Error(ErrorCode::kUnavailable,
                  "what answers at " + name_ +
                      " does not speak landmarkdb's protocol: it sent a "
                      "frame of " +
                      std::to_string(frame.announced_bytes) + " bytes",
                  "--server");
    }
    if (frame.status == FrameStatus::kFrame) {
      v1::Envelope envelope;
      if (!envelope.ParseFromArray(frame.payload.data(), static_cast<int>(frame.payload.size()))) {
        throw Error(ErrorCode::kUnavailable,
                    "what answers at " + name_ + " does not speak landmarkdb's protocol: " +
                        std::to_string(frame.payload.size()) + " bytes that are no message",
                    "--server");
      }
      return envelope;
    }
    const Socket::Read read = socket_->receive_some(chunk, limits);
    if (read.status == Socket::ReadStatus::kClosed) lost();
    if (read.status != Socket::ReadStatus::kBytes) return std::nullopt;
    reader_.feed(std::string_view(chunk.data(), read.bytes));
  }
}

namespace {

// The server's word. What it stopped of itself, as it shuts down, was not interrupted by us.
Error refused(const v1::Error& error, const RunContext& context) {
  Error reason = from_proto(error);
  if (reason.code() != ErrorCode::kCancelled || context.stop.stop_requested()) return reason;
  return Error(ErrorCode::kUnavailable, std::string("the server gave up: ") + reason.what());
}

}  // namespace

std::optional<v1::Envelope> Connection::receive_reply(std::uint64_t id,
                                                      const WaitLimits& limits,
                                                      const RunContext& context) {
  while (std::optional<v1::Envelope> envelope = receive(limits)) {
    switch (envelope->body_case()) {
      case v1::Envelope::kGoAway:
        go_away_ = envelope->go_away().reason();
        continue;
      case v1::Envelope::kPing: {
        v1::Envelope pong;
        pong.mutable_pong()->set_value(envelope->ping().value());
        send(pong, limits);
        continue;
      }
      case v1::Envelope::kError:  // number 0: of the connection, and so of our request too
        if (envelope->request_id() == id || envelope->request_id() == 0) {
          throw refused(envelope->error(), context);
        }
        continue;
      case v1::Envelope::kProgress:
        if (envelope->request_id() == id && context.progress) {
          const v1::Progress& progress = envelope->progress();
          context.progress({progress.stage(), progress.done(), progress.total()});
        }
        continue;
      default:
        if (envelope->request_id() == id) return envelope;
    }
  }
  return std::nullopt;
}

v1::Envelope Connection::call(v1::Envelope request, const RunContext& context) {
  const std::uint64_t id = next_id_++;
  request.set_request_id(id);
  request.set_timeout_ms(left_ms(context));
  WaitLimits limits{context.stop, context.deadline};
  send(request, limits);
  if (limits.deadline) *limits.deadline += kCancelPatience;
  if (std::optional<v1::Envelope> reply = receive_reply(id, limits, context)) {
    return *std::move(reply);
  }
  give_up(id, context.stop.stop_requested(), context);
}

void Connection::give_up(std::uint64_t id, bool stopped, const RunContext& context) {
  const WaitLimits patience{{}, steady_clock::now() + kCancelPatience};
  v1::Envelope cancel;
  cancel.set_request_id(id);
  cancel.mutable_cancel();
  try {
    send(cancel, patience);
    if (stopped) receive_reply(id, patience, context);
  } catch (const Error&) {
    // Its word that it stopped, or the connection's end: either way the request is over.
  }
  if (stopped) throw Error(ErrorCode::kCancelled, "interrupted; the server was told to stop");
  throw Error(ErrorCode::kDeadlineExceeded,
              "the server at " + name_ + " gave no answer within the time allowed (--timeout)");
}

void Connection::lost() const {
  throw Error(ErrorCode::kUnavailable,
              "the server at " + name_ + " closed the connection before it answered" +
                  (go_away_.empty() ? "" : ": " + go_away_));
}

}  // namespace landmarkdb::client
