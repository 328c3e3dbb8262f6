#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <boost/asio/io_context.hpp>
#include <boost/asio/strand.hpp>

#include "server/connection.hpp"

namespace landmarkdb {

using Strand = boost::asio::strand<boost::asio::io_context::executor_type>;

// A place where clients knock. Once started, its members are called on the strand it was made with;
// it must outlive the handlers that run there.
class Listener {
 public:
  // A new connection, on a strand of its own; `peer` is for the log.
  using OnAccept = std::function<void(Connection::Socket socket, std::string peer)>;

  virtual ~Listener() = default;
  virtual void start(OnAccept on_accept) = 0;
  // Takes no more connections. A Unix socket's file is removed.
  virtual void close() = 0;
  // "127.0.0.1:7071", "unix:/run/landmarkdb.sock".
  virtual std::string address() const = 0;
  virtual std::uint16_t port() const { return 0; }  // of TCP
};

// "HOST:PORT" or "[IPv6]:PORT". Throws Error{kInvalidArgument} for anything else.
struct HostPort {
  std::string host;
  std::string port;
};
HostPort parse_host_port(const std::string& text);

// Binds a TCP address. Unless `insecure_allowed`, refuses an address that other machines can reach
// with Error{kPermissionDenied}. A busy port is Error{kUnavailable} naming the address.
std::unique_ptr<Listener> listen_tcp(const Strand& strand,
                                     const std::string& address,
                                     bool insecure_allowed);

// Binds a Unix socket with permissions 0600. A socket file that nobody answers on any more is
// replaced; one that is answered is Error{kUnavailable}; a file of another kind is left alone and
// refused with Error{kInvalidArgument}. Servers that start at once on one path exclude each other
// by a lock on its folder: one of them gets it.
std::unique_ptr<Listener> listen_unix(const Strand& strand, const std::string& path);

}  // namespace landmarkdb
