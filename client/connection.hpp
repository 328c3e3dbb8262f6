#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "client/connect_options.hpp"
#include "client/socket.hpp"
#include "engine/base/run_context.hpp"
#include "proto/framing.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::client {

// One blocking connection to a server, greeted and authenticated. One request at a time; not
// thread-safe. After a call has thrown kUnavailable, kDeadlineExceeded or kCancelled the connection
// may be of no more use: make a new one.
class Connection {
 public:
  // Connects and says Hello. Throws Error: kUnavailable (nobody there, or someone who speaks
  // another protocol), kUnimplemented (another major version), kUnauthenticated or
  // kPermissionDenied (token), kCancelled.
  Connection(const ConnectOptions& options, const RunContext& context);

  const v1::HelloReply& hello() const { return hello_; }

  // Sends the request and waits for its answer; Progress goes to `context.progress`. The
  // context's deadline travels with the request. A stop request sends Cancel, waits for the
  // server's word for at most kCancelPatience, and throws kCancelled. An Error reply is thrown as
  // Error; a connection lost is kUnavailable.
  v1::Envelope call(v1::Envelope request, const RunContext& context);

 private:
  void greet(const ConnectOptions& options, const WaitLimits& limits);
  void send(const v1::Envelope& envelope, const WaitLimits& limits);
  // The next envelope; nullopt when `limits` end first. Throws when the stream is lost.
  std::optional<v1::Envelope> receive(const WaitLimits& limits);
  std::optional<v1::Envelope> receive_reply(std::uint64_t id,
                                            const WaitLimits& limits,
                                            const RunContext& context);
  [[noreturn]] void give_up(std::uint64_t id, bool stopped, const RunContext& context);
  [[noreturn]] void lost() const;

  std::string name_;  // the address as given, for messages
  std::unique_ptr<Socket> socket_;
  FrameReader reader_;
  v1::HelloReply hello_;
  std::uint64_t next_id_ = 1;
  std::string go_away_;  // the reason the server gave, if it will close
};

}  // namespace landmarkdb::client
