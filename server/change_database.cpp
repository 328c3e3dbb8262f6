#include "server/change_database.hpp"

#include <algorithm>
#include <string>

#include "engine/base/error.hpp"

namespace landmarkdb {

Store open_for_change(const ServerOptions& options, const ServerState& state) {
  if (options.read_only) {
    throw Error(ErrorCode::kPermissionDenied,
                "this server was started with --read-only: scenes and models cannot be changed "
                "through it");
  }
  return Store::open_read_write(state.db_path());
}

void put_in_service(const ServerOptions& options, ServerState& state) {
  RunContext context;
  context.stop = state.stop_token();
  context.threads = std::max(options.threads, 1);
  try {
    state.reload(context);
  } catch (const Error& error) {
    throw Error(
        error.code(),
        std::string("the change is stored, but could not be put in service: ") + error.what());
  }
}

}  // namespace landmarkdb
