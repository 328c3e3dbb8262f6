#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "proto/framing.hpp"
#include "server/convert_cloud.hpp"
#include "server/log.hpp"

namespace landmarkdb {

// What one connection may cost. The defaults are for people on a network; tests shorten them.
struct ConnectionLimits {
  std::chrono::milliseconds hello_timeout{10'000};
  // A frame must be complete this long after its first byte, plus the time its length takes at
  // `min_bytes_per_s`.
  std::chrono::milliseconds frame_timeout{10'000};
  std::size_t min_bytes_per_s = std::size_t{64} * 1024;
  std::chrono::milliseconds idle_timeout{600'000};  // without frames and open requests
  std::chrono::milliseconds write_timeout{30'000};  // for one answer to be taken by the peer
  // Answers may wait for a slow reader up to this; then the connection is closed.
  std::size_t max_outbox_bytes = std::size_t{32} * 1024 * 1024;
  // How long a closing connection reads on, so that the last words reach the peer.
  std::chrono::milliseconds linger{2'000};
  std::size_t max_open_requests = 64;
  std::chrono::milliseconds progress_interval{200};
};

struct ServerOptions {
  std::string db{};
  std::string listen = "127.0.0.1:7071";  // HOST:PORT, [IPv6]:PORT; "none": no TCP. Port 0: any.
  std::string unix_path{};                // empty: none
  int threads = 0;                        // 0: one a core
  bool read_only = false;
  bool allow_insecure = false;
  std::string token{};  // empty: none is asked for
  std::size_t max_message_bytes = kDefaultMaxMessageBytes;
  std::size_t max_connections = 128;  // of clients: connections that have said Hello
  // Connections that have not; past it the oldest of them is cut. 0: 256, or as many as clients
  // where that is more, so that all of them may come back at once after a restart.
  std::size_t max_strangers = 0;
  std::chrono::milliseconds deadline{60'000};  // of a query, waiting included
  std::uint64_t max_points = kDefaultMaxPoints;
  // Of the long messages that are being received or worked on, all connections together.
  std::size_t memory_budget_bytes = std::size_t{512} * 1024 * 1024;
  // Of scenes that are read when a query needs them, what is kept.
  std::size_t scene_memory_bytes = std::size_t{1} << 30U;
  // Requests that wait for a thread; more are turned away.
  std::size_t max_waiting_queries = 64;
  std::size_t max_waiting_writes = 16;
  // From the wish to stop: requests still open are cancelled, then connections cut.
  std::chrono::milliseconds stop_cancel_after{2'000};
  std::chrono::milliseconds stop_cut_after{4'000};
  std::string port_file{};  // gets the TCP port as text once it is known; empty: none
  LogLevel log_level = LogLevel::kInfo;
  bool log_json = false;
  ConnectionLimits connection{};
};

}  // namespace landmarkdb
