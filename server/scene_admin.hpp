#pragma once

#include "engine/base/run_context.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/memory_budget.hpp"
#include "server/options.hpp"
#include "server/server_state.hpp"

namespace landmarkdb {

// The scene requests of the wire. Those that change the database open it for writing, refuse with
// Error{kPermissionDenied} on a read-only server, and put the change in service before they answer.
// Each call opens its own Store: thread-safe.
class SceneAdmin {
 public:
  // All must outlive it. The points of scenes to be added are taken from `memory`.
  SceneAdmin(const ServerOptions& options, ServerState& state, MemoryBudget& memory)
      : options_(options), state_(state), memory_(memory) {}

  v1::SceneListReply list() const;
  v1::SceneReply show(const std::string& name) const;
  v1::SceneReply add(const v1::SceneAddRequest& request, const RunContext& context) const;
  v1::SceneRemoveReply remove(const v1::SceneRemoveRequest& request) const;
  v1::SceneReply rename(const v1::SceneRenameRequest& request) const;
  v1::SceneReply rollback(const v1::SceneRollbackRequest& request) const;
  v1::SceneReply tag(const v1::SceneTagRequest& request) const;
  v1::SceneReply add_landmark(const v1::LandmarkAddRequest& request) const;
  v1::SceneReply remove_landmark(const v1::LandmarkRemoveRequest& request) const;

 private:
  const ServerOptions& options_;
  ServerState& state_;
  MemoryBudget& memory_;
};

}  // namespace landmarkdb
