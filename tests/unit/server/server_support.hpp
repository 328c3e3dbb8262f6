#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>

#include "engine/types/point_cloud.hpp"
#include "engine/types/scene_record.hpp"
#include "proto/framing.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/server.hpp"

namespace landmarkdb::testing {

// Removed with all that is in it.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// A small furnished room, described; its name is `name`.
SceneRecord make_record(const std::string& name, std::uint64_t seed = 1);
// What a depth camera sees in the room of that seed.
PointCloud make_view(std::uint64_t seed = 1);
// A cloud of a few thousand points that looks like nothing stored.
PointCloud make_blob();

// A database at `path` that holds the scene "room".
void make_database(const std::string& path);
std::string bytes_of_file(const std::string& path);

v1::Cloud float_message(const PointCloud& cloud);
v1::Envelope query_envelope(std::uint64_t request_id, const PointCloud& cloud);

// A blocking connection to a server, which can also misbehave.
class TestClient {
 public:
  static TestClient tcp(std::uint16_t port);
  static TestClient unix_socket(const std::string& path);
  TestClient(TestClient&& other) noexcept;
  TestClient& operator=(TestClient&&) = delete;
  ~TestClient();

  void send_bytes(std::string_view bytes);
  void send(const v1::Envelope& envelope);
  // The next message; nothing when the server has closed. Throws after `patience`.
  std::optional<v1::Envelope> receive(std::chrono::milliseconds patience = kPatience);
  // Sends Hello and returns the answer.
  v1::Envelope hello(const std::string& token = {});
  // Sends and returns the first message with the request's number that is no Progress.
  v1::Envelope call(const v1::Envelope& envelope);
  v1::Envelope answer_to(std::uint64_t request_id);
  void end_sending();
  // As when the process is killed: unread bytes are thrown away, the peer sees a reset.
  void reset();
  // True when the server closes, whatever it may still send.
  bool closed_by_server(std::chrono::milliseconds patience = kPatience);

  static constexpr std::chrono::milliseconds kPatience{20'000};

 private:
  explicit TestClient(int fd) : fd_(fd) {}
  int fd_;
  FrameReader reader_{kLargestMessageBytes};
};

v1::Envelope hello_envelope(const std::string& token = {});
// Waits until health says that queries are answered (or that loading failed).
v1::HealthReply wait_until_loaded(TestClient& client);

// A server on a free port over a database of its own, with a log that can be read.
struct RunningServer {
  explicit RunningServer(ServerOptions options = {}, bool load = true);
  TestClient client(const std::string& token = {});

  TemporaryFolder folder;
  std::ostringstream log_text;
  Logger log{log_text, LogLevel::kDebug, false};
  ServerOptions options;
  std::unique_ptr<Server> server;
};

}  // namespace landmarkdb::testing
