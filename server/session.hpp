#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <unordered_map>

#include "proto/landmarkdb.pb.h"
#include "server/connection.hpp"
#include "server/dispatcher.hpp"

namespace landmarkdb {

// What all sessions share; outlives them.
struct SessionServices {
  const ServerOptions& options;
  Dispatcher& dispatcher;
  ServerState& state;
  MemoryBudget& budget;
  Counters& counters;
  Logger& log;
  std::atomic<std::size_t> clients{0};  // connections that have said Hello
};

// What a session tells its owner, each once, on the session's strand.
struct SessionEvents {
  std::function<void()> on_greeted;  // Hello is done: a client, no stranger any more
  std::function<void()> on_closed;
};

// One client: Hello first, then requests, any number at once, answered as they are ready.
//
// Requests that are open when the client closes or ends its sending, or when it asks to, are told
// to stop. A connection takes one of the server's places (max_connections) when it says Hello.
// Public members may be called from any thread.
class Session final : public Connection {
 public:
  // `peer` is for the log.
  Session(Socket socket,
          std::uint64_t id,
          std::string peer,
          SessionServices& services,
          SessionEvents events);

  void start();
  // Ends at once, unless Hello has come meanwhile.
  void make_room();
  // The server stops: no new requests; closes once those open are answered.
  void go_away(const std::string& why);
  // Tells the open requests to stop.
  void cancel_requests();
  void close_now();

 private:
  struct OpenRequest {
    std::shared_ptr<Job> job;
    std::unique_ptr<boost::asio::steady_timer> deadline_timer;
  };

  void on_frame(std::string_view payload, MemoryBudget::Lease memory) override;
  void on_broken(ErrorCode code, const std::string& message) override;
  void on_input_end() override;
  void on_idle() override;
  void on_closed(const std::string& why) override;
  bool busy() const override { return !requests_.empty(); }

  void hello(const v1::Envelope& envelope);
  // False: as many clients as may be are connected.
  bool take_place();
  // Sends an error and ends: a Hello that does not do.
  void refuse_hello(const v1::Envelope& answer);
  void submit(v1::Envelope envelope, MemoryBudget::Lease memory);
  void set_deadline(OpenRequest& open);
  void cancel(std::uint64_t request_id);
  void stop_requests();
  // Answers a request that could not be handed on.
  void fail(std::uint64_t request_id, const std::exception& error);
  // Answers a request that no thread has begun to work on; nothing where one has.
  void answer_if_waiting(std::uint64_t request_id, ErrorCode code, const std::string& message);
  void report(std::uint64_t request_id, const Progress& progress);
  void finish(std::uint64_t request_id, const v1::Envelope& answer);
  void send(const v1::Envelope& envelope);
  void send_error(std::uint64_t request_id,
                  ErrorCode code,
                  const std::string& message,
                  const std::string& field = {});
  void close_if_done();
  std::shared_ptr<Session> self() { return std::static_pointer_cast<Session>(shared_from_this()); }

  const std::uint64_t id_;
  const std::string peer_;
  SessionServices& services_;
  SessionEvents events_;
  std::unordered_map<std::uint64_t, OpenRequest> requests_;
  std::shared_ptr<TrackLine> tracks_;  // a job in work holds it too
  bool greeted_ = false;
  bool leaving_ = false;  // no new requests are taken
};

}  // namespace landmarkdb
