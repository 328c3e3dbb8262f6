#include "tests/unit/server/server_support.hpp"

#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include <arpa/inet.h>
#include <google/protobuf/stubs/logging.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "engine/base/random.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "store/store.hpp"
#include "tests/support/make_scene.hpp"

namespace landmarkdb::testing {

namespace {

// Mutated messages would fill the output with protobuf's own complaints.
[[maybe_unused]] auto* const kQuiet = google::protobuf::SetLogHandler(nullptr);

SyntheticScene small_room(std::uint64_t seed) {
  return make_scene({.seed = seed, .furniture = 8, .stations = 2, .rays = 8'000});
}

int connected(int fd, const sockaddr* address, socklen_t length) {
  if (fd < 0 || ::connect(fd, address, length) != 0) {
    throw std::runtime_error(std::string("test client: ") + std::strerror(errno));
  }
  return fd;
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "landmarkdb-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

SceneRecord make_record(const std::string& name, std::uint64_t seed) {
  const SyntheticScene scene = small_room(seed);
  std::vector<Scan> scans;
  for (const PointCloud& cloud : scene.scans) scans.push_back({.cloud = cloud, .source = "a.ply"});
  IndexOptions options;
  options.voxel_m = 0.08;
  return describe_scene(name, std::move(scans), options, {});
}

PointCloud make_view(std::uint64_t seed) {
  const SyntheticScene scene = small_room(seed);
  return view_of(scene, make_view_pose(scene, 3), {});
}

PointCloud make_blob() {
  Random random(5);
  PointCloud cloud;
  for (int i = 0; i < 4000; ++i) {
    cloud.points.emplace_back(static_cast<float>(random.normal()),
                              static_cast<float>(random.normal()),
                              static_cast<float>(3.0 + random.normal()));
  }
  return cloud;
}

void make_database(const std::string& path) {
  Store::create_or_open(path).insert(make_record("room"), {});
}

std::string bytes_of_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

v1::Cloud float_message(const PointCloud& cloud) {
  v1::Cloud message;
  message.set_encoding(v1::POINT_ENCODING_FLOAT32);
  message.set_points(cloud.size());
  message.set_xyz(reinterpret_cast<const char*>(cloud.points.data()),
                  cloud.size() * sizeof(Eigen::Vector3f));
  message.set_width(cloud.width);
  message.set_height(cloud.height);
  return message;
}

v1::Envelope query_envelope(std::uint64_t request_id, const PointCloud& cloud) {
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  *envelope.mutable_query()->add_clouds() = float_message(cloud);
  return envelope;
}

TestClient TestClient::tcp(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return TestClient(connected(::socket(AF_INET, SOCK_STREAM, 0),
                              reinterpret_cast<const sockaddr*>(&address),
                              sizeof(address)));
}

TestClient TestClient::unix_socket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  path.copy(address.sun_path, sizeof(address.sun_path) - 1);
  return TestClient(connected(::socket(AF_UNIX, SOCK_STREAM, 0),
                              reinterpret_cast<const sockaddr*>(&address),
                              sizeof(address)));
}

TestClient::TestClient(TestClient&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), reader_(std::move(other.reader_)) {}

TestClient::~TestClient() {
  if (fd_ >= 0) ::close(fd_);
}

void TestClient::send_bytes(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return;  // the server has closed: receive() will tell
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
}

void TestClient::send(const v1::Envelope& envelope) {
  send_bytes(encode_frame(envelope.SerializeAsString()));
}

std::optional<v1::Envelope> TestClient::receive(std::chrono::milliseconds patience) {
  const auto until = std::chrono::steady_clock::now() + patience;
  while (true) {
    const Frame frame = reader_.next();
    if (frame.status == FrameStatus::kFrame) {
      v1::Envelope envelope;
      if (!envelope.ParseFromArray(frame.payload.data(), static_cast<int>(frame.payload.size()))) {
        throw std::runtime_error("test client: the server sent no Envelope");
      }
      return envelope;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        until - std::chrono::steady_clock::now());
    pollfd ready{fd_, POLLIN, 0};
    if (left.count() <= 0 || ::poll(&ready, 1, static_cast<int>(left.count())) == 0) {
      throw std::runtime_error("test client: nothing came");
    }
    std::array<char, 65536> buffer{};
    const ssize_t got = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (got <= 0) return std::nullopt;
    reader_.feed(std::string_view(buffer.data(), static_cast<std::size_t>(got)));
  }
}

v1::Envelope hello_envelope(const std::string& token) {
  v1::Envelope envelope;
  envelope.set_request_id(1'000'000);
  envelope.mutable_hello()->set_protocol_major(kProtocolMajor);
  envelope.mutable_hello()->set_protocol_minor(kProtocolMinor);
  envelope.mutable_hello()->set_client("test");
  envelope.mutable_hello()->set_token(token);
  return envelope;
}

v1::Envelope TestClient::hello(const std::string& token) { return call(hello_envelope(token)); }

v1::Envelope TestClient::call(const v1::Envelope& envelope) {
  send(envelope);
  return answer_to(envelope.request_id());
}

v1::Envelope TestClient::answer_to(std::uint64_t request_id) {
  while (true) {
    std::optional<v1::Envelope> envelope = receive();
    if (!envelope) throw std::runtime_error("test client: the server closed instead of answering");
    if (envelope->request_id() == request_id && !envelope->has_progress()) return *envelope;
  }
}

void TestClient::end_sending() { ::shutdown(fd_, SHUT_WR); }

void TestClient::reset() {
  const linger now{1, 0};
  ::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &now, sizeof(now));
  ::close(std::exchange(fd_, -1));
}

bool TestClient::closed_by_server(std::chrono::milliseconds patience) {
  try {
    while (receive(patience)) {
    }
    return true;
  } catch (const std::runtime_error&) {
    return false;
  }
}

v1::HealthReply wait_until_loaded(TestClient& client) {
  for (std::uint64_t id = 2'000'000;; ++id) {
    v1::Envelope ask;
    ask.set_request_id(id);
    ask.mutable_health();
    const v1::HealthReply health = client.call(ask).health_reply();
    if (health.status() != v1::HEALTH_STATUS_STARTING) return health;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

RunningServer::RunningServer(ServerOptions given, bool load) : options(std::move(given)) {
  if (options.db.empty()) {
    options.db = folder.file("places.db");
    make_database(options.db);
  }
  if (options.listen == ServerOptions{}.listen) options.listen = "127.0.0.1:0";
  if (options.threads == 0) options.threads = 2;
  server = std::make_unique<Server>(options, log);
  server->start();
  if (!load) return;
  TestClient first = client(options.token);
  wait_until_loaded(first);
}

TestClient RunningServer::client(const std::string& token) {
  TestClient client = TestClient::tcp(server->port());
  client.hello(token);
  return client;
}

}  // namespace landmarkdb::testing
