// The client library asks one question at a time; a client that keeps many open on one connection
// speaks the protocol itself.

#include <array>
#include <map>
#include <optional>
#include <queue>
#include <utility>

#include "bench/load/run_clients.hpp"
#include "client/convert.hpp"
#include "client/socket.hpp"
#include "engine/base/error.hpp"
#include "proto/framing.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBackOff{50};  // after a refusal, as the other clients
constexpr std::size_t kMaxReplyBytes = std::size_t{16} * 1024 * 1024;
constexpr std::size_t kReadChunk = std::size_t{64} * 1024;

class Pipeline {
 public:
  explicit Pipeline(const ClientsOptions& options)
      : socket_(client::parse_address(options.server), options.server, {}),
        reader_(kMaxReplyBytes) {
    v1::Envelope request;
    v1::Hello& hello = *request.mutable_hello();
    hello.set_protocol_major(kProtocolMajor);
    hello.set_protocol_minor(kProtocolMinor);
    hello.set_client("landmarkdb-bench-load");
    hello.set_token(options.token);
    send(encode_frame(request.SerializeAsString()));
    const std::optional<v1::Envelope> reply = receive(std::nullopt);
    if (reply->has_error()) throw client::from_proto(reply->error());
  }

  void send(const std::string& frame) {
    if (!socket_.send_all(frame, {})) lost();
  }

  // The next envelope; nullopt when the deadline passes first.
  std::optional<v1::Envelope> receive(std::optional<Clock::time_point> deadline) {
    std::array<char, kReadChunk> chunk{};
    for (;;) {
      const Frame frame = reader_.next();
      if (frame.status == FrameStatus::kFrame) {
        v1::Envelope envelope;
        if (!envelope.ParseFromArray(frame.payload.data(),
                                     static_cast<int>(frame.payload.size()))) {
          lost();
        }
        return envelope;
      }
      if (frame.status != FrameStatus::kNeedMore) lost();
      const client::Socket::Read read = socket_.receive_some(chunk, {{}, deadline});
      if (read.status == client::Socket::ReadStatus::kDeadline) return std::nullopt;
      if (read.status != client::Socket::ReadStatus::kBytes) lost();
      reader_.feed(std::string_view(chunk.data(), read.bytes));
    }
  }

 private:
  [[noreturn]] static void lost() {
    throw Error(ErrorCode::kUnavailable, "the server closed the heavy client's connection");
  }

  client::Socket socket_;
  FrameReader reader_;
};

// Questions ready to be numbered: turning clouds into bytes must not be what limits the client.
std::vector<v1::Envelope> questions(std::span<const PointCloud> clouds) {
  std::vector<v1::Envelope> all;
  for (const PointCloud& cloud : clouds) {
    v1::Envelope question;
    client::add_to_proto({cloud}, {}, *question.mutable_query());
    *question.mutable_query()->mutable_options() = client::to_proto(QueryOptions{});
    all.push_back(std::move(question));
  }
  return all;
}

Request request_of(const v1::Envelope& reply, Clock::time_point sent) {
  Request request;
  request.milliseconds = std::chrono::duration<double, std::milli>(Clock::now() - sent).count();
  if (!reply.has_error()) return request;
  const bool refused = reply.error().code() == static_cast<int>(ErrorCode::kResourceExhausted);
  request.outcome = refused ? RequestOutcome::kRefused : RequestOutcome::kFailed;
  return request;
}

}  // namespace

std::vector<Request> run_heavy_client(const ClientsOptions& options,
                                      std::size_t in_flight,
                                      std::span<const PointCloud> clouds,
                                      Clock::time_point end) {
  Pipeline pipeline(options);
  std::vector<v1::Envelope> asked = questions(clouds);
  std::vector<Request> requests;
  std::map<std::uint64_t, Clock::time_point> open;
  std::queue<Clock::time_point> due;  // when the questions that are not open may be asked
  for (std::size_t i = 0; i < in_flight; ++i) due.push(Clock::now());
  std::uint64_t next = 1;
  for (;;) {
    while (!due.empty() && due.front() <= Clock::now() && Clock::now() < end) {
      due.pop();
      v1::Envelope& question = asked[next % asked.size()];
      question.set_request_id(next);
      open[next++] = Clock::now();
      pipeline.send(encode_frame(question.SerializeAsString()));
    }
    if (open.empty() && Clock::now() >= end) return requests;
    std::optional<Clock::time_point> wake;
    if (!due.empty() && Clock::now() < end) wake = due.front();
    const std::optional<v1::Envelope> reply = pipeline.receive(wake);
    if (!reply) continue;
    const auto asked_at = open.find(reply->request_id());
    if (reply->has_progress() || asked_at == open.end()) continue;
    const Request request = request_of(*reply, asked_at->second);
    open.erase(asked_at);
    requests.push_back(request);
    due.push(Clock::now() +
             (request.outcome == RequestOutcome::kRefused ? kBackOff : Clock::duration{}));
  }
}

}  // namespace landmarkdb::bench
