#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "proto/framing.hpp"
#include "proto/landmarkdb.pb.h"

namespace landmarkdb::client::testing {

// The server's end of one connection, blocking; what a test's script talks through.
class FakePeer {
 public:
  explicit FakePeer(int fd) : fd_(fd), reader_(kLargestMessageBytes) {}

  // The next envelope; nullopt at the end of the stream.
  std::optional<v1::Envelope> receive();
  void send(const v1::Envelope& envelope);
  void send_bytes(const std::string& bytes);
  // Takes the Hello and answers it with these features.
  void greet(const std::string& feature = "zstd");

 private:
  int fd_;
  FrameReader reader_;
};

// Listens on a free port of the loopback, takes one connection and runs the script on it in a
// thread of its own; closes it when the script ends.
class FakeServer {
 public:
  explicit FakeServer(std::function<void(FakePeer&)> script);
  ~FakeServer();
  FakeServer(const FakeServer&) = delete;
  FakeServer& operator=(const FakeServer&) = delete;

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }

 private:
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::jthread thread_;
};

}  // namespace landmarkdb::client::testing
