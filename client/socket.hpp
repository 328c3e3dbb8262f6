#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>

#include "client/address.hpp"

namespace landmarkdb::client {

using TimePoint = std::chrono::steady_clock::time_point;

// When a blocking call on a socket gives up.
struct WaitLimits {
  std::stop_token stop;
  std::optional<TimePoint> deadline;
};

// A connected stream socket, owned. Every call waits until it can go on, the deadline passes or a
// stop is requested, whichever is first. Not thread-safe.
class Socket {
 public:
  // Throws Error{kUnavailable} when nobody answers there, kPermissionDenied where the Unix socket
  // may not be opened, kDeadlineExceeded and kCancelled as `limits` say. `name` is for messages.
  Socket(const Address& address, std::string name, const WaitLimits& limits);
  ~Socket();
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  // Sends everything. Returns false when the peer has closed its end; throws as above.
  bool send_all(std::string_view bytes, const WaitLimits& limits);

  enum class ReadStatus { kBytes, kClosed, kDeadline, kStopped };
  struct Read {
    ReadStatus status = ReadStatus::kBytes;
    std::size_t bytes = 0;  // > 0 of kBytes
  };
  // Reads what is there, at least one byte. Does not throw.
  Read receive_some(std::span<char> into, const WaitLimits& limits);

 private:
  enum class Ready { kYes, kDeadline, kStopped };
  Ready wait(short events, const WaitLimits& limits) const;
  void connect_to(const void* address, unsigned length, const WaitLimits& limits);
  [[noreturn]] void give_up_connecting(Ready why) const;
  void connect_unix(const std::string& path, const WaitLimits& limits);
  void connect_tcp(const Address& address, const WaitLimits& limits);
  [[noreturn]] void fail_to_connect(int error) const;
  void close_now();

  std::string name_;
  int fd_ = -1;
};

}  // namespace landmarkdb::client
