#include "server/listener.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <thread>
#include <type_traits>
#include <utility>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/error.hpp"

namespace landmarkdb {

namespace {

using boost::asio::ip::tcp;
using boost::asio::local::stream_protocol;
using boost::system::error_code;

// When accepting fails (no file descriptors left), trying again at once would only burn the core.
constexpr std::chrono::milliseconds kAcceptPause{100};

std::string text_of(const tcp::endpoint& endpoint) {
  const std::string host = endpoint.address().to_string();
  return (endpoint.address().is_v6() ? "[" + host + "]" : host) + ":" +
         std::to_string(endpoint.port());
}
std::string text_of(const stream_protocol::endpoint& endpoint) {
  return endpoint.path().empty() ? "unix" : "unix:" + endpoint.path();
}

template <typename Socket>
void tune([[maybe_unused]] Socket& socket) {
  if constexpr (std::is_same_v<typename Socket::protocol_type, tcp>) {
    error_code ignored;
    socket.set_option(tcp::no_delay(true), ignored);
    socket.set_option(boost::asio::socket_base::keep_alive(true), ignored);
  }
}

template <typename Protocol>
class SocketListener : public Listener {
 public:
  SocketListener(const Strand& strand, const typename Protocol::endpoint& endpoint)
      : acceptor_(strand), strand_(strand), pause_(strand) {
    acceptor_.open(endpoint.protocol());
    if constexpr (std::is_same_v<Protocol, tcp>) {
      acceptor_.set_option(boost::asio::socket_base::reuse_address(true));
    }
    acceptor_.bind(endpoint);
    acceptor_.listen();
  }

  void start(OnAccept on_accept) override {
    on_accept_ = std::move(on_accept);
    accept();
  }

  void close() override {
    error_code ignored;
    acceptor_.close(ignored);
    pause_.cancel();
  }

  std::string address() const override { return text_of(acceptor_.local_endpoint()); }

 protected:
  typename Protocol::acceptor acceptor_;

 private:
  void accept() {
    acceptor_.async_accept(boost::asio::make_strand(strand_.get_inner_executor()),
                           [this](const error_code& error, auto socket) {
                             if (!acceptor_.is_open()) return;
                             if (error) {
                               pause_.expires_after(kAcceptPause);
                               pause_.async_wait([this](const error_code& cancelled) {
                                 if (!cancelled) accept();
                               });
                               return;
                             }
                             tune(socket);
                             error_code unnamed;
                             const auto peer = socket.remote_endpoint(unnamed);
                             on_accept_(Connection::Socket(std::move(socket)),
                                        unnamed ? "?" : text_of(peer));
                             accept();
                           });
  }

  Strand strand_;
  boost::asio::steady_timer pause_;
  OnAccept on_accept_;
};

class TcpListener final : public SocketListener<tcp> {
 public:
  using SocketListener::SocketListener;
  std::uint16_t port() const override { return acceptor_.local_endpoint().port(); }
};

// Held while the socket file of a folder is looked at and made or removed, which takes a
// millisecond: of two servers that start at once, one sees what the other has done. The folder
// itself is locked, so no lock file is left that somebody might remove too early. The kernel lets
// go of it when the process ends.
class FolderLock {
 public:
  // Waits for at most `patience`; held() tells whether it came.
  FolderLock(const std::string& path, std::chrono::milliseconds patience) {
    std::string folder = std::filesystem::path(path).parent_path().string();
    if (folder.empty()) folder = ".";
    fd_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd_ < 0) {
      error_ = errno;
      return;
    }
    constexpr std::chrono::milliseconds kTick{2};
    const auto until = std::chrono::steady_clock::now() + patience;
    while (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
      error_ = errno;
      if (error_ != EWOULDBLOCK && error_ != EINTR) return;
      if (std::chrono::steady_clock::now() >= until) return;
      std::this_thread::sleep_for(kTick);
    }
    error_ = 0;
  }
  ~FolderLock() {
    if (fd_ >= 0) ::close(fd_);
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

  bool held() const { return fd_ >= 0 && error_ == 0; }
  int error() const { return error_; }  // an errno, where it is not held

 private:
  int fd_ = -1;
  int error_ = 0;
};

class UnixListener final : public SocketListener<stream_protocol> {
 public:
  UnixListener(const Strand& strand, const std::string& path)
      : SocketListener(strand, stream_protocol::endpoint(path)), path_(path) {
    struct stat info {};
    if (::stat(path_.c_str(), &info) == 0) inode_ = info.st_ino;
  }

  // The file is removed only while it is still ours: before the socket is closed, as until then
  // no other file gets its inode and no other server takes it for abandoned.
  void close() override {
    constexpr std::chrono::milliseconds kPatience{200};  // a file that stays does no harm
    if (inode_ != 0) {
      const FolderLock lock(path_, kPatience);
      struct stat info {};
      if (lock.held() && ::lstat(path_.c_str(), &info) == 0 && info.st_ino == inode_) {
        ::unlink(path_.c_str());
      }
    }
    inode_ = 0;
    SocketListener::close();
  }

  std::string address() const override { return "unix:" + path_; }

 private:
  std::string path_;
  ino_t inode_ = 0;
};

// Removes a socket file that a server which did not end well has left.
void remove_stale_socket(const Strand& strand, const std::string& path) {
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0) return;
  if (!S_ISSOCK(info.st_mode)) {
    throw Error(ErrorCode::kInvalidArgument,
                path + ": there is a file that is no socket, it is left alone",
                "--unix");
  }
  stream_protocol::socket probe(strand);
  error_code error;
  probe.connect(stream_protocol::endpoint(path), error);
  if (error != boost::asio::error::connection_refused) {
    throw Error(ErrorCode::kUnavailable,
                "cannot listen on unix:" + path + ": " +
                    (error ? error.message() : std::string("another server answers there")),
                "--unix");
  }
  if (::unlink(path.c_str()) != 0) {
    throw Error(
        ErrorCode::kPermissionDenied,
        path + ": the socket file nobody answers on cannot be removed: " + std::strerror(errno),
        "--unix");
  }
}

[[noreturn]] void throw_cannot_listen(const std::string& address,
                                      const error_code& error,
                                      const std::string& option) {
  const bool forbidden = error == boost::asio::error::access_denied;
  throw Error(forbidden ? ErrorCode::kPermissionDenied : ErrorCode::kUnavailable,
              "cannot listen on " + address + ": " + error.message(),
              option);
}

}  // namespace

HostPort parse_host_port(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  HostPort parts;
  if (colon != std::string::npos) {
    parts.host = text.substr(0, colon);
    parts.port = text.substr(colon + 1);
  }
  if (parts.host.size() > 2 && parts.host.front() == '[' && parts.host.back() == ']') {
    parts.host = parts.host.substr(1, parts.host.size() - 2);
  } else if (parts.host.find_first_of(":[]") != std::string::npos) {
    parts.host.clear();  // an IPv6 address without brackets: which colon ends it is a guess
  }
  const bool digits = !parts.port.empty() && parts.port.size() <= 5 &&
                      parts.port.find_first_not_of("0123456789") == std::string::npos;
  if (parts.host.empty() || !digits || std::stoul(parts.port) > 65535) {
    throw Error(ErrorCode::kInvalidArgument,
                "'" + text + "' is no address, want HOST:PORT or [IPv6]:PORT",
                "--listen");
  }
  return parts;
}

std::unique_ptr<Listener> listen_tcp(const Strand& strand,
                                     const std::string& address,
                                     bool insecure_allowed) {
  const HostPort parts = parse_host_port(address);
  error_code error;
  const auto found = tcp::resolver(strand).resolve(
      parts.host, parts.port, tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error) throw_cannot_listen(address, error, "--listen");
  // A name such as localhost may stand for both kinds of address; clients try IPv4 more often.
  auto chosen = std::find_if(found.begin(), found.end(), [](const auto& entry) {
    return entry.endpoint().address().is_v4();
  });
  if (chosen == found.end()) chosen = found.begin();
  const tcp::endpoint endpoint = chosen->endpoint();
  if (!insecure_allowed && !endpoint.address().is_loopback()) {
    throw Error(ErrorCode::kPermissionDenied,
                "other machines can reach " + address +
                    ": give --token-file so that clients must know a token, or --allow-insecure",
                "--listen");
  }
  try {
    return std::make_unique<TcpListener>(strand, endpoint);
  } catch (const boost::system::system_error& failed) {
    throw_cannot_listen(text_of(endpoint), failed.code(), "--listen");
  }
}

std::unique_ptr<Listener> listen_unix(const Strand& strand, const std::string& path) {
  if (path.empty() || path.size() >= sizeof(sockaddr_un::sun_path)) {
    throw Error(ErrorCode::kInvalidArgument,
                "the path of a Unix socket has " + std::to_string(path.size()) +
                    " bytes, want 1 to " + std::to_string(sizeof(sockaddr_un::sun_path) - 1),
                "--unix");
  }
  constexpr std::chrono::milliseconds kPatience{2'000};  // others hold it for a millisecond
  const FolderLock lock(path, kPatience);
  if (!lock.held()) {
    throw_cannot_listen("unix:" + path + " (its folder cannot be locked)",
                        error_code(lock.error(), boost::system::system_category()),
                        "--unix");
  }
  remove_stale_socket(strand, path);
  const mode_t before = ::umask(0177);  // 0600 from the moment the file exists
  try {
    auto listener = std::make_unique<UnixListener>(strand, path);
    ::umask(before);
    return listener;
  } catch (const boost::system::system_error& failed) {
    ::umask(before);
    throw_cannot_listen("unix:" + path, failed.code(), "--unix");
  }
}

}  // namespace landmarkdb
