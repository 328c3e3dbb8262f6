#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace landmarkdb::client {

inline constexpr const char* kDefaultServer = "127.0.0.1:7071";

struct ConnectOptions {
  std::string server = kDefaultServer;                // HOST:PORT, [IPV6]:PORT or unix:PATH
  std::string token = {};                             // where the server asks for one
  std::string client = "landmarkdb";                  // program and version, for the server's log
  std::chrono::milliseconds connect_timeout{10'000};  // until Hello is answered
  std::size_t max_reply_bytes = std::size_t{256} * 1024 * 1024;
};

// What the server said of itself in Hello.
struct ServerInfo {
  std::string version;
  std::uint32_t protocol_major = 0;
  std::uint32_t protocol_minor = 0;
  std::uint32_t database_version = 0;
  std::uint64_t generation = 0;
  std::uint64_t max_message_bytes = 0;
  std::uint64_t max_points = 0;
  std::vector<std::string> features;
};

}  // namespace landmarkdb::client
