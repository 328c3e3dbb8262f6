#pragma once

#include "server/options.hpp"
#include "server/server_state.hpp"
#include "store/store.hpp"

namespace landmarkdb {

// The database, opened for a change that a request asks for; Error{kPermissionDenied} on a
// read-only server.
Store open_for_change(const ServerOptions& options, const ServerState& state);

// What was written is on disk, whatever happens to the request now: neither its deadline nor its
// Cancel holds for this, only the server's end.
void put_in_service(const ServerOptions& options, ServerState& state);

}  // namespace landmarkdb
