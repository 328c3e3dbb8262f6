#include "client/address.hpp"

#include <algorithm>

#include <sys/un.h>

#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

constexpr std::string_view kUnixPrefix = "unix:";
constexpr std::string_view kDefaultPort = "7071";
constexpr std::size_t kMaxUnixPath = sizeof(sockaddr_un::sun_path) - 1;

[[noreturn]] void refuse(std::string_view text, const std::string& why) {
  throw Error(ErrorCode::kFailedPrecondition,
              "server address '" + std::string(text) + "': " + why +
                  ", want HOST:PORT, [IPV6]:PORT or unix:PATH",
              "--server");
}

bool is_port(std::string_view text) {
  const bool digits = !text.empty() && text.size() <= 5 &&
                      std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  return digits && std::stoi(std::string(text)) >= 1 && std::stoi(std::string(text)) <= 65535;
}

}  // namespace

Address parse_address(std::string_view text) {
  Address address;
  if (text.starts_with(kUnixPrefix)) {
    address.path = text.substr(kUnixPrefix.size());
    if (address.path.empty()) refuse(text, "the path is empty");
    if (address.path.size() > kMaxUnixPath) refuse(text, "the path is longer than 107 bytes");
    return address;
  }
  std::string_view port = kDefaultPort;
  std::string_view host = text;
  if (text.starts_with('[')) {
    const std::size_t close = text.find(']');
    if (close == std::string_view::npos) refuse(text, "no closing bracket");
    host = text.substr(1, close - 1);
    const std::string_view rest = text.substr(close + 1);
    if (!rest.empty() && rest.front() != ':') refuse(text, "no port after the bracket");
    if (!rest.empty()) port = rest.substr(1);
  } else if (const std::size_t colon = text.rfind(':'); colon != std::string_view::npos) {
    host = text.substr(0, colon);
    port = text.substr(colon + 1);
    if (host.find(':') != std::string_view::npos) refuse(text, "an IPv6 host needs brackets");
  }
  if (host.empty()) refuse(text, "no host");
  if (!is_port(port)) refuse(text, "'" + std::string(port) + "' is no port");
  address.host = host;
  address.port = port;
  return address;
}

}  // namespace landmarkdb::client
