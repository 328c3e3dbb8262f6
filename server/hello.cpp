#include "server/hello.hpp"

#include <algorithm>
#include <fstream>

#include "cli/version.hpp"
#include "engine/base/error.hpp"
#include "server/request_handler.hpp"
#include "store/store.hpp"

namespace landmarkdb {

namespace {

constexpr std::size_t kMaxTokenBytes = 4096;

std::string version_name(std::uint32_t major, std::uint32_t minor) {
  return std::to_string(major) + "." + std::to_string(minor);
}

}  // namespace

bool same_secret(std::string_view given, std::string_view wanted) {
  unsigned difference = given.size() == wanted.size() ? 0U : 1U;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const char other = wanted.empty() ? '\0' : wanted[i % wanted.size()];
    difference |= static_cast<unsigned char>(given[i] ^ other);
  }
  return difference == 0;
}

std::string read_token_file(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::kInvalidArgument, path + ": cannot be read", "--token-file");
  std::string text(kMaxTokenBytes, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  text.resize(std::min(text.size(), text.find('\n')));
  constexpr std::string_view kBlanks = " \t\r";
  text.erase(0, std::min(text.size(), text.find_first_not_of(kBlanks)));
  text.resize(text.find_last_not_of(kBlanks) + 1);
  if (text.empty()) {
    throw Error(
        ErrorCode::kInvalidArgument, path + ": the first line holds no token", "--token-file");
  }
  return text;
}

v1::Envelope answer_hello(const v1::Envelope& first,
                          const ServerOptions& options,
                          const ServerState& state) {
  const std::uint64_t id = first.request_id();
  if (!first.has_hello()) {
    return error_envelope(id,
                          ErrorCode::kFailedPrecondition,
                          "the first message must be Hello, this is '" + request_name(first) + "'");
  }
  const v1::Hello& hello = first.hello();
  if (hello.protocol_major() != kProtocolMajor) {
    return error_envelope(
        id,
        ErrorCode::kUnimplemented,
        "the client speaks protocol " +
            version_name(hello.protocol_major(), hello.protocol_minor()) + ", this server " +
            version_name(kProtocolMajor, kProtocolMinor) + ": the " +
            (hello.protocol_major() < kProtocolMajor ? "client" : "server") + " is too old",
        "protocol_major");
  }
  if (!options.token.empty() && !same_secret(hello.token(), options.token)) {
    return error_envelope(id,
                          ErrorCode::kUnauthenticated,
                          hello.token().empty() ? "this server asks for a token (--token-file)"
                                                : "the token is not this server's",
                          "token");
  }

  v1::Envelope envelope;
  envelope.set_request_id(id);
  v1::HelloReply& reply = *envelope.mutable_hello_reply();
  reply.set_protocol_major(kProtocolMajor);
  reply.set_protocol_minor(kProtocolMinor);
  reply.set_server_version(std::string(cli::program_version()));
  reply.set_database_version(static_cast<std::uint32_t>(schema_version()));
  if (const auto served = state.served_or_null()) reply.set_generation(served->generation);
  for (const char* feature : {"zstd", "int16"}) reply.add_features(feature);
  if (options.read_only) reply.add_features("read_only");
  reply.set_max_message_bytes(options.max_message_bytes);
  reply.set_max_points(options.max_points);
  reply.set_max_deadline_ms(static_cast<std::uint32_t>(options.deadline.count()));
  return envelope;
}

}  // namespace landmarkdb
