#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/answers.hpp"
#include "client/connect_options.hpp"
#include "client/recognition.hpp"
#include "client/tracking.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::client {

// A landmarkdb server, asked over one blocking connection.
//
//   Client client({.server = "unix:/run/landmarkdb.sock"}, {});
//   const QueryResult answer = client.query(read_cloud("view.ply", {}), {}, {});
//
// Every call takes a RunContext: its deadline travels with the request, its stop token cancels it
// at the server, its progress callback hears what the server reports. Every call throws Error:
// what the server replied, or kUnavailable when it is not there any more. One call at a time; not
// thread-safe; make one Client a thread.
class Client {
 public:
  Client(const ConnectOptions& options, const RunContext& context);
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  const ServerInfo& server() const;

  // Where were these clouds taken? One in the sensor frame, or several with their poses in a frame
  // they share; metres, NaN allowed; each seen from its zero unless it has a viewpoint. "Not found"
  // is an answer. Nothing is thinned on the way; points travel as float32.
  QueryResult query(std::span<const QueryCloud> clouds,
                    const QueryOptions& options,
                    const RunContext& context);

  // Which model is this, and where? "Not found" is an answer.
  RecognizeAnswer recognize(const RecognizeInput& input,
                            const RecognizeOptions& options,
                            const RunContext& context);

  // Follows one model from image to image: open, frames in their order, close. Tracks end with the
  // client. "Lost" is an answer; a frame that is refused leaves the track as it was.
  std::uint32_t open_track(const TrackSetup& setup, const RunContext& context);
  TrackedFrame track(std::uint32_t track, const TrackInput& input, const RunContext& context);
  void close_track(std::uint32_t track, const RunContext& context);

  std::vector<ModelSummary> models(const RunContext& context);  // by name
  ModelInfo model(const std::string& name, const RunContext& context);
  ModelInfo add_model(const ModelAdd& add, const RunContext& context);
  void remove_model(const std::string& name, const RunContext& context);
  ModelInfo rename_model(const std::string& old_name,
                         const std::string& new_name,
                         const RunContext& context);

  std::vector<SceneInfo> scenes(const RunContext& context);  // by name
  SceneInfo scene(const std::string& name, const RunContext& context);
  SceneInfo add_scene(const SceneAdd& add, const RunContext& context);
  void remove_scene(const std::string& name, const RunContext& context);
  SceneInfo rename_scene(const std::string& old_name,
                         const std::string& new_name,
                         const RunContext& context);
  SceneInfo rollback_scene(const std::string& name, const RunContext& context);
  // An empty value takes the tag away.
  SceneInfo tag_scene(const std::string& name,
                      const std::map<std::string, std::string>& tags,
                      const RunContext& context);
  SceneInfo add_landmark(const std::string& scene,
                         const Landmark& landmark,
                         const RunContext& context);
  SceneInfo remove_landmark(const std::string& scene,
                            const std::string& landmark,
                            const RunContext& context);

  Stats stats(const RunContext& context);
  Health health(const RunContext& context);
  Reload reload(const RunContext& context);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace landmarkdb::client
