#pragma once

#include <string>

#include "engine/base/run_context.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/options.hpp"
#include "server/server_state.hpp"

namespace landmarkdb {

// The model requests of the wire; as SceneAdmin does for scenes. Thread-safe.
class ModelAdmin {
 public:
  // Both must outlive it.
  ModelAdmin(const ServerOptions& options, ServerState& state) : options_(options), state_(state) {}

  v1::ModelListReply list() const;
  v1::ModelReply show(const std::string& name) const;
  v1::ModelReply add(const v1::ModelAddRequest& request, const RunContext& context) const;
  v1::ModelRemoveReply remove(const v1::ModelRemoveRequest& request) const;
  v1::ModelReply rename(const v1::ModelRenameRequest& request) const;

 private:
  v1::ModelInfo info(const class Store& store, const std::string& name) const;

  const ServerOptions& options_;
  ServerState& state_;
};

}  // namespace landmarkdb
