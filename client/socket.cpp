#include "client/socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

// How soon a stop request is seen; a person does not notice it.
constexpr std::chrono::milliseconds kTick{50};
// A server accepts thousands a second: soon enough, and no load for it.
constexpr std::chrono::milliseconds kConnectAgain{10};

struct AddressListDeleter {
  void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using AddressList = std::unique_ptr<addrinfo, AddressListDeleter>;

AddressList resolve(const Address& address) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int rc = getaddrinfo(address.host.c_str(), address.port.c_str(), &hints, &list);
  if (rc != 0) {
    throw Error(ErrorCode::kUnavailable,
                "host '" + address.host + "' is not known: " + gai_strerror(rc),
                "--server");
  }
  return AddressList(list);
}

int open_socket(int family) {
  const int fd = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) {
    throw Error(ErrorCode::kUnavailable, std::string("cannot open a socket: ") + strerror(errno));
  }
  return fd;
}

}  // namespace

Socket::Socket(const Address& address, std::string name, const WaitLimits& limits)
    : name_(std::move(name)) {
  try {
    address.path.empty() ? connect_tcp(address, limits) : connect_unix(address.path, limits);
  } catch (...) {
    close_now();
    throw;
  }
}

Socket::~Socket() { close_now(); }

void Socket::close_now() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

void Socket::fail_to_connect(int error) const {
  const bool denied = error == EACCES || error == EPERM;
  throw Error(denied ? ErrorCode::kPermissionDenied : ErrorCode::kUnavailable,
              "no landmarkdb server answers at " + name_ + ": " + strerror(error) +
                  (denied ? "" : "; is it running?"),
              "--server");
}

void Socket::give_up_connecting(Ready why) const {
  if (why == Ready::kStopped) {
    throw Error(ErrorCode::kCancelled, "interrupted while connecting to " + name_);
  }
  throw Error(ErrorCode::kUnavailable,
              "no landmarkdb server answers at " + name_ + " within the time allowed",
              "--server");
}

// Connects fd_; throws where that fails.
void Socket::connect_to(const void* address, unsigned length, const WaitLimits& limits) {
  while (::connect(fd_, static_cast<const sockaddr*>(address), length) != 0) {
    if (errno == EINPROGRESS || errno == EINTR) break;
    if (errno != EAGAIN) fail_to_connect(errno);
    // A Unix socket whose backlog is full (or TCP without a free local port): no connection is
    // under way, so there is nothing to poll for.
    if (limits.stop.stop_requested()) give_up_connecting(Ready::kStopped);
    if (limits.deadline && std::chrono::steady_clock::now() >= *limits.deadline) {
      give_up_connecting(Ready::kDeadline);
    }
    std::this_thread::sleep_for(kConnectAgain);
  }
  const Ready ready = wait(POLLOUT, limits);
  if (ready != Ready::kYes) give_up_connecting(ready);
  int error = 0;
  socklen_t size = sizeof error;
  if (getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  if (error != 0) fail_to_connect(error);
}

void Socket::connect_unix(const std::string& path, const WaitLimits& limits) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(path, address.sun_path);  // parse_address has checked the length
  fd_ = open_socket(AF_UNIX);
  connect_to(&address, sizeof address, limits);
}

void Socket::connect_tcp(const Address& address, const WaitLimits& limits) {
  const AddressList list = resolve(address);
  for (const addrinfo* one = list.get(); one != nullptr; one = one->ai_next) {
    close_now();
    fd_ = open_socket(one->ai_family);
    try {
      connect_to(one->ai_addr, one->ai_addrlen, limits);
      break;
    } catch (const Error& error) {
      // "localhost" is ::1 and 127.0.0.1: the next address may be the one.
      if (error.code() != ErrorCode::kUnavailable || one->ai_next == nullptr) throw;
    }
  }
  const int on = 1;  // requests are written whole: nothing to gather
  setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

Socket::Ready Socket::wait(short events, const WaitLimits& limits) const {
  for (;;) {
    if (limits.stop.stop_requested()) return Ready::kStopped;
    std::chrono::milliseconds patience = kTick;
    if (limits.deadline) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(
          *limits.deadline - std::chrono::steady_clock::now());
      if (left.count() <= 0) return Ready::kDeadline;
      patience = std::min(patience, left);
    }
    pollfd one{.fd = fd_, .events = events, .revents = 0};
    if (::poll(&one, 1, static_cast<int>(patience.count())) > 0) return Ready::kYes;
  }
}

bool Socket::send_all(std::string_view bytes, const WaitLimits& limits) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
    switch (wait(POLLOUT, limits)) {
      case Ready::kYes:
        break;
      case Ready::kStopped:
        throw Error(ErrorCode::kCancelled, "interrupted while sending to " + name_);
      case Ready::kDeadline:
        throw Error(ErrorCode::kDeadlineExceeded, name_ + " did not take the request in time");
    }
  }
  return true;
}

Socket::Read Socket::receive_some(std::span<char> into, const WaitLimits& limits) {
  for (;;) {
    switch (wait(POLLIN, limits)) {
      case Ready::kYes:
        break;
      case Ready::kStopped:
        return {ReadStatus::kStopped, 0};
      case Ready::kDeadline:
        return {ReadStatus::kDeadline, 0};
    }
    const ssize_t got = ::recv(fd_, into.data(), into.size(), 0);
    if (got > 0) return {ReadStatus::kBytes, static_cast<std::size_t>(got)};
    if (got < 0 && (errno == EINTR || errno == EAGAIN || errno == EWOULDBLOCK)) continue;
    return {ReadStatus::kClosed, 0};
  }
}

}  // namespace landmarkdb::client
