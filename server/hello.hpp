#pragma once

#include <string>
#include <string_view>

#include "proto/landmarkdb.pb.h"
#include "server/options.hpp"
#include "server/server_state.hpp"

namespace landmarkdb {

// The answer to a connection's first message: HelloReply, or an Error after which the connection
// must be closed: no Hello, another protocol (kUnimplemented), a wrong token (kUnauthenticated).
v1::Envelope answer_hello(const v1::Envelope& first,
                          const ServerOptions& options,
                          const ServerState& state);

// The same in a time that does not depend on where the two differ.
bool same_secret(std::string_view given, std::string_view wanted);

// The secret in a token file: its first line without blanks at its ends. Throws
// Error{kInvalidArgument} when there is no such file or nothing in it.
std::string read_token_file(const std::string& path);

}  // namespace landmarkdb
