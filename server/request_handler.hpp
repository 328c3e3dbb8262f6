#pragma once

#include <string>

#include "engine/base/run_context.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/memory_budget.hpp"
#include "server/model_admin.hpp"
#include "server/options.hpp"
#include "server/scene_admin.hpp"
#include "server/server_state.hpp"
#include "server/track_store.hpp"
#include "server/work_queue.hpp"

namespace landmarkdb {

// Where a request is worked on.
enum class Lane {
  kInline,   // at once, on the connection's own thread: takes microseconds, never waits
  kCompute,  // reads the database or computes; many at a time
  kTrack,    // the same, but those of one connection one after the other, as they came
  kWrite,    // changes the database or what is in service; one at a time
};
Lane lane_of(const v1::Envelope& request);

// "query", "scene_add": the request's name in logs and messages.
std::string request_name(const v1::Envelope& request);

// An answer that carries an error; `request_id` as given.
v1::Envelope error_envelope(std::uint64_t request_id,
                            ErrorCode code,
                            const std::string& message,
                            const std::string& field = {});

// Turns a request into its answer: the one place where an Error becomes a message. Knows no socket.
// Thread-safe.
class RequestHandler {
 public:
  // All must outlive the handler. Decoded clouds are taken from `memory`.
  RequestHandler(const ServerOptions& options,
                 ServerState& state,
                 Counters& counters,
                 const WorkQueue& compute,
                 MemoryBudget& memory)
      : options_(options),
        state_(state),
        counters_(counters),
        compute_(compute),
        memory_(memory),
        admin_(options, state, memory),
        model_admin_(options, state) {}

  // Never throws. `context` says when to stop and whom to tell of progress. `tracks` are those of
  // the connection, used by one call at a time; null: nothing can be tracked.
  v1::Envelope handle(const v1::Envelope& request,
                      const RunContext& context,
                      TrackStore* tracks = nullptr);

 private:
  void dispatch(const v1::Envelope& request,
                const RunContext& context,
                TrackStore* tracks,
                v1::Envelope& reply);
  v1::TrackFrameResult track(const v1::TrackFrameRequest& request,
                             const RunContext& context,
                             TrackStore& tracks);
  v1::QueryResult query(const v1::QueryRequest& request, const RunContext& context);
  v1::RecognizeResult recognize(const v1::RecognizeRequest& request, const RunContext& context);
  v1::StatsReply stats() const;
  v1::HealthReply health() const;
  v1::ReloadReply reload(const RunContext& context);

  const ServerOptions& options_;
  ServerState& state_;
  Counters& counters_;
  const WorkQueue& compute_;
  MemoryBudget& memory_;
  SceneAdmin admin_;
  ModelAdmin model_admin_;
};

}  // namespace landmarkdb
