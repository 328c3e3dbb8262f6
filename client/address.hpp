#pragma once

#include <string>
#include <string_view>

namespace landmarkdb::client {

// Where a server listens: a Unix socket when `path` is set, else host and port.
struct Address {
  std::string path;
  std::string host;
  std::string port;
};

// Reads "HOST:PORT", "[IPV6]:PORT", "HOST" (port 7071) or "unix:PATH". Throws
// Error{kFailedPrecondition} with the text seen when it is none of these.
Address parse_address(std::string_view text);

}  // namespace landmarkdb::client
