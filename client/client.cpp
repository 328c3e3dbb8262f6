#include "client/client.hpp"

#include <algorithm>
#include <utility>

#include "client/connection.hpp"
#include "client/convert.hpp"
#include "client/convert_recognition.hpp"
#include "client/convert_track.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::client {
namespace {

ServerInfo server_info(const v1::HelloReply& hello) {
  return {.version = hello.server_version(),
          .protocol_major = hello.protocol_major(),
          .protocol_minor = hello.protocol_minor(),
          .database_version = hello.database_version(),
          .generation = hello.generation(),
          .max_message_bytes = hello.max_message_bytes(),
          .max_points = hello.max_points(),
          .features = {hello.features().begin(), hello.features().end()}};
}

// The answer must be of the kind the request asks for; another one is the server's mistake.
void expect(const v1::Envelope& reply, v1::Envelope::BodyCase wanted) {
  if (reply.body_case() == wanted) return;
  throw Error(ErrorCode::kInternal,
              "the server answered with message " + std::to_string(reply.body_case()) +
                  ", want message " + std::to_string(wanted));
}

}  // namespace

struct Client::State {
  State(const ConnectOptions& options, const RunContext& context)
      : connection(options, context), info(server_info(connection.hello())) {}

  CloudEncoding encoding() const {
    return {.zstd = std::ranges::find(info.features, "zstd") != info.features.end()};
  }

  void check_points(std::uint64_t points) const {
    if (info.max_points == 0 || points <= info.max_points) return;
    throw Error(ErrorCode::kResourceExhausted,
                "the cloud has " + std::to_string(points) + " points, the server takes at most " +
                    std::to_string(info.max_points) + " in one request: thin it first");
  }

  v1::Envelope call(v1::Envelope request,
                    v1::Envelope::BodyCase wanted,
                    const RunContext& context) {
    v1::Envelope reply = connection.call(std::move(request), context);
    expect(reply, wanted);
    return reply;
  }

  SceneInfo call_for_scene(v1::Envelope request, const RunContext& context) {
    return from_proto(
        call(std::move(request), v1::Envelope::kSceneReply, context).scene_reply().scene());
  }

  ModelInfo call_for_model(v1::Envelope request, const RunContext& context) {
    const v1::Envelope reply = call(std::move(request), v1::Envelope::kModelReply, context);
    return {from_proto(reply.model_reply().model()),
            reply.model_reply().json(),
            reply.model_reply().replaced()};
  }

  Connection connection;
  ServerInfo info;
};

Client::Client(const ConnectOptions& options, const RunContext& context)
    : state_(std::make_unique<State>(options, context)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

const ServerInfo& Client::server() const { return state_->info; }

QueryResult Client::query(std::span<const QueryCloud> clouds,
                          const QueryOptions& options,
                          const RunContext& context) {
  std::size_t points = 0;
  for (const QueryCloud& one : clouds) points += one.cloud.size();
  state_->check_points(points);
  v1::Envelope request;
  for (const QueryCloud& one : clouds) {
    add_to_proto(one, state_->encoding(), *request.mutable_query());
  }
  *request.mutable_query()->mutable_options() = to_proto(options);
  return from_proto(
      state_->call(std::move(request), v1::Envelope::kQueryResult, context).query_result());
}

RecognizeAnswer Client::recognize(const RecognizeInput& input,
                                  const RecognizeOptions& options,
                                  const RunContext& context) {
  v1::Envelope request;
  *request.mutable_recognize() = to_proto(input, options);
  return from_proto(
      state_->call(std::move(request), v1::Envelope::kRecognizeResult, context).recognize_result());
}

std::uint32_t Client::open_track(const TrackSetup& setup, const RunContext& context) {
  v1::Envelope request;
  *request.mutable_track_open() = to_proto(setup);
  return state_->call(std::move(request), v1::Envelope::kTrackOpenReply, context)
      .track_open_reply()
      .track();
}

TrackedFrame Client::track(std::uint32_t track,
                           const TrackInput& input,
                           const RunContext& context) {
  v1::Envelope request;
  *request.mutable_track_frame() = to_proto(input, track);
  return from_proto(state_->call(std::move(request), v1::Envelope::kTrackFrameResult, context)
                        .track_frame_result());
}

void Client::close_track(std::uint32_t track, const RunContext& context) {
  v1::Envelope request;
  request.mutable_track_close()->set_track(track);
  state_->call(std::move(request), v1::Envelope::kTrackCloseReply, context);
}

std::vector<ModelSummary> Client::models(const RunContext& context) {
  v1::Envelope request;
  request.mutable_model_list();
  const v1::Envelope reply =
      state_->call(std::move(request), v1::Envelope::kModelListReply, context);
  std::vector<ModelSummary> out;
  for (const v1::ModelInfo& model : reply.model_list_reply().models()) {
    out.push_back(from_proto(model));
  }
  return out;
}

ModelInfo Client::model(const std::string& name, const RunContext& context) {
  v1::Envelope request;
  request.mutable_model_show()->set_name(name);
  return state_->call_for_model(std::move(request), context);
}

ModelInfo Client::add_model(const ModelAdd& add, const RunContext& context) {
  v1::Envelope request;
  *request.mutable_model_add() = to_proto(add);
  return state_->call_for_model(std::move(request), context);
}

void Client::remove_model(const std::string& name, const RunContext& context) {
  v1::Envelope request;
  request.mutable_model_remove()->set_name(name);
  state_->call(std::move(request), v1::Envelope::kModelRemoveReply, context);
}

ModelInfo Client::rename_model(const std::string& old_name,
                               const std::string& new_name,
                               const RunContext& context) {
  v1::Envelope request;
  request.mutable_model_rename()->set_old_name(old_name);
  request.mutable_model_rename()->set_new_name(new_name);
  return state_->call_for_model(std::move(request), context);
}

std::vector<SceneInfo> Client::scenes(const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_list();
  const v1::Envelope reply =
      state_->call(std::move(request), v1::Envelope::kSceneListReply, context);
  std::vector<SceneInfo> out;
  for (const v1::SceneInfo& scene : reply.scene_list_reply().scenes()) {
    out.push_back(from_proto(scene));
  }
  return out;
}

SceneInfo Client::scene(const std::string& name, const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_show()->set_name(name);
  return state_->call_for_scene(std::move(request), context);
}

SceneInfo Client::add_scene(const SceneAdd& add, const RunContext& context) {
  std::uint64_t points = 0;
  for (const SceneScan& scan : add.scans) points += scan.cloud.size();
  state_->check_points(points);
  v1::Envelope request;
  *request.mutable_scene_add() = to_proto(add, state_->encoding());
  return state_->call_for_scene(std::move(request), context);
}

void Client::remove_scene(const std::string& name, const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_remove()->set_name(name);
  state_->call(std::move(request), v1::Envelope::kSceneRemoveReply, context);
}

SceneInfo Client::rename_scene(const std::string& old_name,
                               const std::string& new_name,
                               const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_rename()->set_old_name(old_name);
  request.mutable_scene_rename()->set_new_name(new_name);
  return state_->call_for_scene(std::move(request), context);
}

SceneInfo Client::rollback_scene(const std::string& name, const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_rollback()->set_name(name);
  return state_->call_for_scene(std::move(request), context);
}

SceneInfo Client::tag_scene(const std::string& name,
                            const std::map<std::string, std::string>& tags,
                            const RunContext& context) {
  v1::Envelope request;
  request.mutable_scene_tag()->set_name(name);
  for (const auto& [key, value] : tags) (*request.mutable_scene_tag()->mutable_tags())[key] = value;
  return state_->call_for_scene(std::move(request), context);
}

SceneInfo Client::add_landmark(const std::string& scene,
                               const Landmark& landmark,
                               const RunContext& context) {
  v1::Envelope request;
  request.mutable_landmark_add()->set_scene(scene);
  *request.mutable_landmark_add()->mutable_landmark() = to_proto(landmark);
  return state_->call_for_scene(std::move(request), context);
}

SceneInfo Client::remove_landmark(const std::string& scene,
                                  const std::string& landmark,
                                  const RunContext& context) {
  v1::Envelope request;
  request.mutable_landmark_remove()->set_scene(scene);
  request.mutable_landmark_remove()->set_landmark(landmark);
  return state_->call_for_scene(std::move(request), context);
}

Stats Client::stats(const RunContext& context) {
  v1::Envelope request;
  request.mutable_stats();
  return from_proto(
      state_->call(std::move(request), v1::Envelope::kStatsReply, context).stats_reply());
}

Health Client::health(const RunContext& context) {
  v1::Envelope request;
  request.mutable_health();
  return from_proto(
      state_->call(std::move(request), v1::Envelope::kHealthReply, context).health_reply());
}

Reload Client::reload(const RunContext& context) {
  v1::Envelope request;
  request.mutable_reload();
  const v1::Envelope reply = state_->call(std::move(request), v1::Envelope::kReloadReply, context);
  return {.generation = reply.reload_reply().generation(),
          .scenes = reply.reload_reply().scenes(),
          .quarantined = reply.reload_reply().quarantined()};
}

}  // namespace landmarkdb::client
