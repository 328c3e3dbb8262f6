#include "server/request_handler.hpp"

#include <chrono>
#include <exception>
#include <new>
#include <utility>

#include <google/protobuf/descriptor.h>

#include "cli/version.hpp"
#include "engine/base/error.hpp"
#include "server/convert_query.hpp"
#include "server/process_memory.hpp"
#include "server/recognition.hpp"
#include "store/store.hpp"

namespace landmarkdb {

namespace {

// What a client that was turned away should wait before it tries again.
constexpr std::uint32_t kRetryAfter_ms = 500;

void count_verdict(const QueryResult& result, Counters& counters) {
  switch (result.status) {
    case QueryStatus::kLocalized:
      ++counters.localized;
      break;
    case QueryStatus::kAmbiguous:
      ++counters.ambiguous;
      break;
    case QueryStatus::kNotFound:
      ++counters.not_found;
      break;
  }
}

void raise_to(std::atomic<std::uint64_t>& maximum, std::uint64_t value) {
  std::uint64_t seen = maximum;
  while (seen < value && !maximum.compare_exchange_weak(seen, value)) {
  }
}

std::uint64_t microseconds_since(std::chrono::steady_clock::time_point start) {
  const auto passed = std::chrono::steady_clock::now() - start;
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(passed).count());
}

TrackStore& need(TrackStore* tracks) {
  if (tracks != nullptr) return *tracks;
  throw Error(ErrorCode::kFailedPrecondition, "tracking needs a connection that stays open");
}

}  // namespace

Lane lane_of(const v1::Envelope& request) {
  switch (request.body_case()) {
    case v1::Envelope::kQuery:
    case v1::Envelope::kSceneList:
    case v1::Envelope::kSceneShow:
    case v1::Envelope::kRecognize:
    case v1::Envelope::kModelList:
    case v1::Envelope::kModelShow:
      return Lane::kCompute;
    case v1::Envelope::kTrackOpen:
    case v1::Envelope::kTrackFrame:
    case v1::Envelope::kTrackClose:
      return Lane::kTrack;
    case v1::Envelope::kSceneAdd:
    case v1::Envelope::kSceneRemove:
    case v1::Envelope::kSceneRename:
    case v1::Envelope::kSceneRollback:
    case v1::Envelope::kSceneTag:
    case v1::Envelope::kLandmarkAdd:
    case v1::Envelope::kLandmarkRemove:
    case v1::Envelope::kModelAdd:
    case v1::Envelope::kModelRemove:
    case v1::Envelope::kModelRename:
    case v1::Envelope::kReload:
      return Lane::kWrite;
    default:
      return Lane::kInline;
  }
}

std::string request_name(const v1::Envelope& request) {
  const auto* field = v1::Envelope::descriptor()->FindFieldByNumber(request.body_case());
  return field != nullptr ? field->name() : "nothing this server knows";
}

v1::Envelope error_envelope(std::uint64_t request_id,
                            ErrorCode code,
                            const std::string& message,
                            const std::string& field) {
  v1::Envelope envelope;
  envelope.set_request_id(request_id);
  v1::Error& error = *envelope.mutable_error();
  error.set_code(static_cast<v1::Code>(code));
  error.set_message(message);
  error.set_field(field);
  if (code == ErrorCode::kResourceExhausted || code == ErrorCode::kUnavailable) {
    error.set_retry_after_ms(kRetryAfter_ms);
  }
  return envelope;
}

v1::Envelope RequestHandler::handle(const v1::Envelope& request,
                                    const RunContext& context,
                                    TrackStore* tracks) {
  const std::uint64_t id = request.request_id();
  try {
    v1::Envelope reply;
    reply.set_request_id(id);
    context.check("waiting");
    dispatch(request, context, tracks, reply);
    return reply;
  } catch (const Error& error) {
    return error_envelope(id, error.code(), error.what(), error.field());
  } catch (const std::bad_alloc&) {
    return error_envelope(id, ErrorCode::kResourceExhausted, "the server has no memory for this");
  } catch (const std::exception& error) {
    return error_envelope(
        id, ErrorCode::kInternal, std::string("an error of the server itself: ") + error.what());
  } catch (...) {
    return error_envelope(id, ErrorCode::kInternal, "an error of the server itself");
  }
}

void RequestHandler::dispatch(const v1::Envelope& request,
                              const RunContext& context,
                              TrackStore* tracks,
                              v1::Envelope& reply) {
  switch (request.body_case()) {
    case v1::Envelope::kPing:
      reply.mutable_pong()->set_value(request.ping().value());
      break;
    case v1::Envelope::kQuery:
      *reply.mutable_query_result() = query(request.query(), context);
      break;
    case v1::Envelope::kSceneList:
      *reply.mutable_scene_list_reply() = admin_.list();
      break;
    case v1::Envelope::kSceneShow:
      *reply.mutable_scene_reply() = admin_.show(request.scene_show().name());
      break;
    case v1::Envelope::kSceneAdd:
      *reply.mutable_scene_reply() = admin_.add(request.scene_add(), context);
      break;
    case v1::Envelope::kSceneRemove:
      *reply.mutable_scene_remove_reply() = admin_.remove(request.scene_remove());
      break;
    case v1::Envelope::kSceneRename:
      *reply.mutable_scene_reply() = admin_.rename(request.scene_rename());
      break;
    case v1::Envelope::kSceneRollback:
      *reply.mutable_scene_reply() = admin_.rollback(request.scene_rollback());
      break;
    case v1::Envelope::kSceneTag:
      *reply.mutable_scene_reply() = admin_.tag(request.scene_tag());
      break;
    case v1::Envelope::kLandmarkAdd:
      *reply.mutable_scene_reply() = admin_.add_landmark(request.landmark_add());
      break;
    case v1::Envelope::kLandmarkRemove:
      *reply.mutable_scene_reply() = admin_.remove_landmark(request.landmark_remove());
      break;
    case v1::Envelope::kRecognize:
      *reply.mutable_recognize_result() = recognize(request.recognize(), context);
      break;
    case v1::Envelope::kTrackOpen:
      *reply.mutable_track_open_reply() = need(tracks).open(request.track_open(), *state_.served());
      break;
    case v1::Envelope::kTrackFrame:
      *reply.mutable_track_frame_result() = track(request.track_frame(), context, need(tracks));
      break;
    case v1::Envelope::kTrackClose:
      *reply.mutable_track_close_reply() = need(tracks).close(request.track_close());
      break;
    case v1::Envelope::kModelList:
      *reply.mutable_model_list_reply() = model_admin_.list();
      break;
    case v1::Envelope::kModelShow:
      *reply.mutable_model_reply() = model_admin_.show(request.model_show().name());
      break;
    case v1::Envelope::kModelAdd:
      *reply.mutable_model_reply() = model_admin_.add(request.model_add(), context);
      break;
    case v1::Envelope::kModelRemove:
      *reply.mutable_model_remove_reply() = model_admin_.remove(request.model_remove());
      break;
    case v1::Envelope::kModelRename:
      *reply.mutable_model_reply() = model_admin_.rename(request.model_rename());
      break;
    case v1::Envelope::kStats:
      *reply.mutable_stats_reply() = stats();
      break;
    case v1::Envelope::kHealth:
      *reply.mutable_health_reply() = health();
      break;
    case v1::Envelope::kReload:
      *reply.mutable_reload_reply() = reload(context);
      break;
    case v1::Envelope::BODY_NOT_SET:
      throw Error(ErrorCode::kUnimplemented,
                  "the message holds no request that this server (protocol " +
                      std::to_string(kProtocolMajor) + "." + std::to_string(kProtocolMinor) +
                      ") knows");
    default:
      throw Error(ErrorCode::kInvalidArgument, "'" + request_name(request) + "' is no request");
  }
}

v1::QueryResult RequestHandler::query(const v1::QueryRequest& request, const RunContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const std::shared_ptr<const Served> served = state_.served();
  const QueryOptions options = from_proto(request.options());
  PointAllowance allowance{options_.max_points, &memory_};
  std::vector<QueryCloud> clouds = clouds_from_proto(request, allowance);
  const StageTimings::Duration load = std::chrono::steady_clock::now() - start;

  QueryResult result = served->localizer->query(std::move(clouds), options, context);
  result.timings.load += load;
  result.timings.total += load;
  count_verdict(result, counters_);
  const auto us = static_cast<std::uint64_t>(result.timings.total.count() * 1000.0);
  counters_.query_us_total += us;
  raise_to(counters_.query_us_max, us);

  v1::QueryResult reply = to_proto(result);
  reply.set_generation(served->generation);
  return reply;
}

v1::RecognizeResult RequestHandler::recognize(const v1::RecognizeRequest& request,
                                              const RunContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const std::shared_ptr<const Served> served = state_.served();
  v1::RecognizeResult reply = landmarkdb::recognize(request, *served, memory_, context);
  reply.set_generation(served->generation);
  ++(reply.status() == v1::RECOGNIZE_STATUS_RECOGNIZED ? counters_.recognized
                                                       : counters_.recognize_not_found);
  const std::uint64_t us = microseconds_since(start);
  counters_.recognize_us_total += us;
  raise_to(counters_.recognize_us_max, us);
  return reply;
}

v1::TrackFrameResult RequestHandler::track(const v1::TrackFrameRequest& request,
                                           const RunContext& context,
                                           TrackStore& tracks) {
  const auto start = std::chrono::steady_clock::now();
  v1::TrackFrameResult reply = tracks.next(request, memory_, context);
  ++counters_.track_frames;
  if (reply.status() == v1::TRACK_STATUS_TRACKED || reply.status() == v1::TRACK_STATUS_RECOGNIZED) {
    ++counters_.track_frames_seen;
  }
  const std::uint64_t us = microseconds_since(start);
  counters_.track_us_total += us;
  raise_to(counters_.track_us_max, us);
  return reply;
}

v1::StatsReply RequestHandler::stats() const {
  v1::StatsReply reply;
  reply.set_server_version(std::string(cli::program_version()));
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - counters_.started;
  reply.set_uptime_s(up.count());
  if (const std::shared_ptr<const Served> served = state_.served_or_null()) {
    reply.set_generation(served->generation);
    reply.set_scenes(served->scenes);
    reply.set_quarantined(served->damaged().size() + served->damaged_models.size());
    reply.set_points(served->points);
    reply.set_keypoints(served->keypoints);
    reply.set_models(served->models->entries.size());
    const LoadedScenes loaded = served->localizer->loaded();
    reply.set_scenes_on_demand(loaded.scenes);
    reply.set_scene_memory_bytes(loaded.bytes);
    reply.set_scene_loads(loaded.loads);
  }
  reply.set_connections(counters_.connections);
  reply.set_connections_total(counters_.connections_total);
  reply.set_requests_total(counters_.requests_total);
  reply.set_errors_total(counters_.errors_total);
  reply.set_queries_localized(counters_.localized);
  reply.set_queries_ambiguous(counters_.ambiguous);
  reply.set_queries_not_found(counters_.not_found);
  reply.set_in_flight(counters_.in_flight);
  reply.set_queued(compute_.waiting());
  reply.set_rejected_total(counters_.rejected_total);
  reply.set_threads(static_cast<std::uint32_t>(compute_.threads()));
  const std::uint64_t queries = counters_.localized + counters_.ambiguous + counters_.not_found;
  if (queries > 0) {
    reply.set_query_ms_mean(static_cast<double>(counters_.query_us_total) / 1000.0 /
                            static_cast<double>(queries));
  }
  reply.set_recognized(counters_.recognized);
  reply.set_recognize_not_found(counters_.recognize_not_found);
  const std::uint64_t recognitions = counters_.recognized + counters_.recognize_not_found;
  if (recognitions > 0) {
    reply.set_recognize_ms_mean(static_cast<double>(counters_.recognize_us_total) / 1000.0 /
                                static_cast<double>(recognitions));
  }
  reply.set_recognize_ms_max(static_cast<double>(counters_.recognize_us_max) / 1000.0);
  reply.set_tracks_open(counters_.tracks_open);
  const std::uint64_t frames = counters_.track_frames;
  reply.set_track_frames(frames);
  reply.set_track_frames_seen(counters_.track_frames_seen);
  if (frames > 0) {
    reply.set_track_ms_mean(static_cast<double>(counters_.track_us_total) / 1000.0 /
                            static_cast<double>(frames));
  }
  reply.set_track_ms_max(static_cast<double>(counters_.track_us_max) / 1000.0);
  reply.set_query_ms_max(static_cast<double>(counters_.query_us_max) / 1000.0);
  reply.set_resident_bytes(resident_bytes());
  reply.set_database_bytes(file_bytes(state_.db_path()));
  reply.set_reloads_total(counters_.reloads_total);
  return reply;
}

v1::HealthReply RequestHandler::health() const {
  const Health health = state_.health();
  v1::HealthReply reply;
  for (const std::string& problem : health.problems) reply.add_problems(problem);
  for (const std::string& scene : health.quarantined) reply.add_quarantined(scene);
  switch (health.phase) {
    case Phase::kStarting:
      reply.set_status(v1::HEALTH_STATUS_STARTING);
      break;
    case Phase::kServing:
      reply.set_status(health.problems.empty() ? v1::HEALTH_STATUS_OK : v1::HEALTH_STATUS_DEGRADED);
      reply.set_ready(true);
      break;
    case Phase::kFailed:
      reply.set_status(v1::HEALTH_STATUS_FAILED);
      break;
    case Phase::kStopping:
      reply.set_status(v1::HEALTH_STATUS_STOPPING);
      break;
  }
  return reply;
}

v1::ReloadReply RequestHandler::reload(const RunContext& context) {
  const std::shared_ptr<const Served> served = state_.reload(context);
  ++counters_.reloads_total;
  v1::ReloadReply reply;
  reply.set_generation(served->generation);
  reply.set_scenes(served->scenes);
  reply.set_quarantined(served->damaged().size() + served->damaged_models.size());
  return reply;
}

}  // namespace landmarkdb
