#include "client/render_server.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

std::string scenes_of(std::uint64_t scenes, std::uint64_t quarantined) {
  std::string text = cli::count_text(scenes) + (scenes == 1 ? " scene" : " scenes");
  if (quarantined > 0) text += ", " + cli::count_text(quarantined) + " damaged and not served";
  return text;
}

std::string rounded(double value, const std::string& unit) {
  return cli::count_text(static_cast<std::uint64_t>(std::llround(value))) + ' ' + unit;
}

}  // namespace

Json stats_json(const Stats& s) {
  return {{"server_version", s.server_version},
          {"uptime_s", s.uptime_s},
          {"generation", s.generation},
          {"scenes", s.scenes},
          {"quarantined", s.quarantined},
          {"points", s.points},
          {"keypoints", s.keypoints},
          {"connections", s.connections},
          {"connections_total", s.connections_total},
          {"requests_total", s.requests_total},
          {"errors_total", s.errors_total},
          {"queries_localized", s.queries_localized},
          {"queries_ambiguous", s.queries_ambiguous},
          {"queries_not_found", s.queries_not_found},
          {"in_flight", s.in_flight},
          {"queued", s.queued},
          {"rejected_total", s.rejected_total},
          {"threads", s.threads},
          {"query_ms_mean", s.query_ms_mean},
          {"query_ms_max", s.query_ms_max},
          {"models", s.models},
          {"recognized", s.recognized},
          {"recognize_not_found", s.recognize_not_found},
          {"recognize_ms_mean", s.recognize_ms_mean},
          {"recognize_ms_max", s.recognize_ms_max},
          {"tracks_open", s.tracks_open},
          {"track_frames", s.track_frames},
          {"track_frames_seen", s.track_frames_seen},
          {"track_ms_mean", s.track_ms_mean},
          {"track_ms_max", s.track_ms_max},
          {"resident_bytes", s.resident_bytes},
          {"database_bytes", s.database_bytes},
          {"reloads_total", s.reloads_total},
          {"scenes_on_demand", s.scenes_on_demand},
          {"scene_memory_bytes", s.scene_memory_bytes},
          {"scene_loads", s.scene_loads}};
}

std::string stats_text(const Stats& s) {
  std::string text;
  const auto line = [&text](std::string label, const std::string& value) {
    constexpr std::size_t kLabelWidth = 14;
    label.resize(kLabelWidth, ' ');
    text += label + value + '\n';
  };
  line("server", cli::printable(s.server_version) + ", up " + rounded(s.uptime_s, "s"));
  line("serves",
       scenes_of(s.scenes, s.quarantined) + ", " + cli::count_text(s.points) + " points, " +
           cli::count_text(s.keypoints) + " keypoints (generation " + std::to_string(s.generation) +
           ")");
  line("queries",
       cli::count_text(s.queries_localized) + " localized, " +
           cli::count_text(s.queries_ambiguous) + " ambiguous, " +
           cli::count_text(s.queries_not_found) + " not found");
  line("query time",
       "mean " + rounded(s.query_ms_mean, "ms") + ", longest " + rounded(s.query_ms_max, "ms"));
  line("images",
       cli::count_text(s.recognized) + " recognized, " + cli::count_text(s.recognize_not_found) +
           " not found, by " + cli::count_text(s.models) + " models; mean " +
           rounded(s.recognize_ms_mean, "ms") + ", longest " + rounded(s.recognize_ms_max, "ms"));
  line("tracks",
       cli::count_text(s.tracks_open) + " open; " + cli::count_text(s.track_frames) +
           " frames, the object seen in " + cli::count_text(s.track_frames_seen) + "; mean " +
           rounded(s.track_ms_mean, "ms") + ", longest " + rounded(s.track_ms_max, "ms"));
  line("requests",
       cli::count_text(s.requests_total) + ", of these " + cli::count_text(s.errors_total) +
           " failed; " + cli::count_text(s.rejected_total) + " turned away, " +
           cli::count_text(s.in_flight) + " running, " + cli::count_text(s.queued) + " waiting");
  line("connections",
       cli::count_text(s.connections) + " open, " + cli::count_text(s.connections_total) +
           " in all");
  line("memory", cli::bytes_text(s.resident_bytes));
  if (s.scenes_on_demand > 0) {
    line("on demand",
         cli::counted(s.scenes_on_demand, "scene") + ", " + cli::bytes_text(s.scene_memory_bytes) +
             " of them in memory; read " + cli::count_text(s.scene_loads) + " times");
  }
  line("database", cli::bytes_text(s.database_bytes));
  line("threads", cli::count_text(s.threads));
  return text;
}

Json health_json(const Health& health) {
  return {{"status", health.status},
          {"ready", health.ready},
          {"problems", health.problems},
          {"quarantined", health.quarantined}};
}

std::string health_text(const Health& health) {
  std::string text =
      cli::printable(health.status) + (health.ready ? ", ready" : ", not ready") + '\n';
  for (const std::string& problem : health.problems) {
    text += "  " + cli::printable(problem) + '\n';
  }
  for (const std::string& scene : health.quarantined) {
    text += "  scene " + cli::printable(scene) + " is damaged and not served\n";
  }
  return text;
}

Json reload_json(const Reload& reload) {
  return {{"generation", reload.generation},
          {"scenes", reload.scenes},
          {"quarantined", reload.quarantined}};
}

std::string reload_text(const Reload& reload) {
  return "serving " + scenes_of(reload.scenes, reload.quarantined) + " (generation " +
         std::to_string(reload.generation) + ")\n";
}

}  // namespace landmarkdb::client
