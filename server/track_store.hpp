#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>

#include "engine/base/run_context.hpp"
#include "proto/landmarkdb.pb.h"
#include "server/memory_budget.hpp"
#include "server/server_state.hpp"

namespace landmarkdb {

// A track costs little, but an image may take long: several connections share the threads better.
inline constexpr std::size_t kMaxTracks = 4;

// The models that one connection follows. Used by one thread at a time.
class TrackStore {
 public:
  // `counters` must outlive it; tracks_open counts what is open.
  explicit TrackStore(Counters& counters);
  ~TrackStore();
  TrackStore(const TrackStore&) = delete;
  TrackStore& operator=(const TrackStore&) = delete;

  // Each throws Error that names the field: kInvalidArgument, kNotFound for a model or track that
  // is not there, kResourceExhausted for one track too many.
  v1::TrackOpenReply open(const v1::TrackOpenRequest& request, const Served& served);
  // A decoded image takes its memory from `memory`. After an Error the track is as it was, but that
  // a stopped search may count as a frame without the object.
  v1::TrackFrameResult next(const v1::TrackFrameRequest& request,
                            MemoryBudget& memory,
                            const RunContext& context);
  v1::TrackCloseReply close(const v1::TrackCloseRequest& request);

 private:
  class Track;
  Track& find(std::uint32_t track);

  Counters& counters_;
  std::map<std::uint32_t, std::unique_ptr<Track>> tracks_;
  std::uint32_t next_ = 1;
};

}  // namespace landmarkdb
