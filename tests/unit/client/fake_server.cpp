#include "tests/unit/client/fake_server.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace landmarkdb::client::testing {

std::optional<v1::Envelope> FakePeer::receive() {
  std::array<char, 65536> chunk{};
  for (;;) {
    const Frame frame = reader_.next();
    if (frame.status == FrameStatus::kFrame) {
      v1::Envelope envelope;
      if (!envelope.ParseFromArray(frame.payload.data(), static_cast<int>(frame.payload.size()))) {
        return std::nullopt;
      }
      return envelope;
    }
    const ssize_t got = ::recv(fd_, chunk.data(), chunk.size(), 0);
    if (got <= 0) return std::nullopt;
    reader_.feed({chunk.data(), static_cast<std::size_t>(got)});
  }
}

void FakePeer::send(const v1::Envelope& envelope) {
  send_bytes(encode_frame(envelope.SerializeAsString()));
}

void FakePeer::send_bytes(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t one = ::send(fd_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (one <= 0) return;
    sent += static_cast<std::size_t>(one);
  }
}

void FakePeer::greet(const std::string& feature) {
  receive();
  v1::Envelope reply;
  v1::HelloReply& hello = *reply.mutable_hello_reply();
  hello.set_protocol_major(kProtocolMajor);
  hello.set_protocol_minor(kProtocolMinor);
  hello.set_server_version("9.8.7");
  hello.add_features(feature);
  hello.set_max_message_bytes(1'000'000);
  hello.set_max_points(50'000);
  send(reply);
}

FakeServer::FakeServer(std::function<void(FakePeer&)> script) {
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const generic = reinterpret_cast<sockaddr*>(&address);
  if (::bind(listener_, generic, size) != 0 || ::listen(listener_, 1) != 0 ||
      ::getsockname(listener_, generic, &size) != 0) {
    throw std::runtime_error("no loopback port for the fake server");
  }
  port_ = ntohs(address.sin_port);
  thread_ = std::jthread([listener = listener_, script = std::move(script)] {
    const int fd = ::accept(listener, nullptr, nullptr);
    if (fd < 0) return;
    FakePeer peer(fd);
    script(peer);
    ::close(fd);
  });
}

FakeServer::~FakeServer() {
  ::shutdown(listener_, SHUT_RDWR);  // ends an accept() that nobody answered
  thread_.join();
  ::close(listener_);
}

}  // namespace landmarkdb::client::testing
