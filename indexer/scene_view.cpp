#include "indexer/scene_view.hpp"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"

namespace landmarkdb::indexer {
namespace {

using cli::Align;
using nlohmann::ordered_json;

ordered_json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string vector_text(const Eigen::Vector3d& v) {
  return number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z());
}

ordered_json version_json(const VersionSummary& version) {
  ordered_json object = {{"version", version.version},
                         {"created", version.created},
                         {"active", version.active},
                         {"points", version.points},
                         {"keypoints", version.keypoints},
                         {"bytes", version.bytes},
                         {"sha256", version.sha256}};
  if (version.damage) object["damage"] = *version.damage;
  return object;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "-" : text;
}

std::string tags_text(const std::map<std::string, std::string>& tags) {
  std::vector<std::string> parts;
  parts.reserve(tags.size());
  for (const auto& [key, value] : tags) parts.push_back(key + '=' + value);
  return joined(parts);
}

std::string versions_text(const std::vector<VersionSummary>& versions) {
  cli::Table table({{"VERSION", Align::kRight},
                    {"CREATED"},
                    {"POINTS", Align::kRight},
                    {"KEYPOINTS", Align::kRight},
                    {"SIZE", Align::kRight},
                    {"STATE"}});
  for (const VersionSummary& version : versions) {
    std::string state = version.active ? "active" : "";
    if (version.damage) state += (state.empty() ? "" : ", ") + ("damaged: " + *version.damage);
    table.add({std::to_string(version.version),
               version.created,
               cli::count_text(version.points),
               cli::count_text(version.keypoints),
               cli::bytes_text(version.bytes),
               state});
  }
  return table.text();
}

}  // namespace

std::string_view kind_name(EntryKind kind) {
  return kind == EntryKind::kPlace ? "place" : "object";
}

std::string_view keypoint_method_name(KeypointMethod method) {
  switch (method) {
    case KeypointMethod::kUniform:
      return "uniform";
    case KeypointMethod::kStructure:
      return "structure";
    case KeypointMethod::kIss:
      return "iss";
    case KeypointMethod::kNarf:
      return "narf";
  }
  return "structure";
}

ordered_json options_json(const FeatureOptions& options) {
  return {{"voxel_m", options.voxel_m},
          {"normal_radius_m", options.normal_radius_m},
          {"shot_radius_m", options.shot_radius_m},
          {"keypoint_spacing_m", options.keypoint_spacing_m},
          {"keypoints", keypoint_method_name(options.keypoints)}};
}

ordered_json landmark_json(const Landmark& landmark) {
  return {{"name", landmark.name},
          {"min_m", vector_json(landmark.min_m)},
          {"max_m", vector_json(landmark.max_m)}};
}

ordered_json landmarks_json(const std::vector<Landmark>& landmarks) {
  ordered_json array = ordered_json::array();
  for (const Landmark& landmark : landmarks) array.push_back(landmark_json(landmark));
  return array;
}

ordered_json scene_json(const SceneSummary& scene, bool with_versions) {
  ordered_json object = {{"name", scene.name},
                         {"scene_id", scene.id},
                         {"version", scene.active_version},
                         {"kind", kind_name(scene.kind)},
                         {"state", scene.damage ? "quarantined" : "active"},
                         {"points", scene.points},
                         {"keypoints", scene.keypoints},
                         {"bytes", scene.bytes},
                         {"created", scene.created},
                         {"options", options_json(scene.options)},
                         {"tags", scene.tags},
                         {"landmarks", landmarks_json(scene.landmarks)},
                         {"sources", scene.sources},
                         {"warnings", scene.warnings}};
  object["up"] = scene.up ? vector_json(*scene.up) : ordered_json(nullptr);
  if (scene.damage) object["state_reason"] = *scene.damage;
  if (with_versions) {
    ordered_json versions = ordered_json::array();
    for (const VersionSummary& version : scene.versions) versions.push_back(version_json(version));
    object["versions"] = std::move(versions);
  }
  return object;
}

std::string scenes_text(const std::vector<SceneSummary>& scenes) {
  if (scenes.empty()) return "no scenes\n";
  cli::Table table({{"NAME"},
                    {"KIND"},
                    {"VERSION", Align::kRight},
                    {"POINTS", Align::kRight},
                    {"KEYPOINTS", Align::kRight},
                    {"SIZE", Align::kRight},
                    {"CREATED"},
                    {"STATE"}});
  for (const SceneSummary& scene : scenes) {
    table.add({scene.name,
               std::string(kind_name(scene.kind)),
               std::to_string(scene.active_version),
               cli::count_text(scene.points),
               cli::count_text(scene.keypoints),
               cli::bytes_text(scene.bytes),
               scene.created,
               scene.damage ? "damaged" : "active"});
  }
  return table.text();
}

std::string landmarks_text(const std::vector<Landmark>& landmarks) {
  if (landmarks.empty()) return "no landmarks\n";
  cli::Table table({{"LANDMARK"}, {"MIN (m)"}, {"MAX (m)"}});
  for (const Landmark& landmark : landmarks) {
    table.add({landmark.name, vector_text(landmark.min_m), vector_text(landmark.max_m)});
  }
  return table.text();
}

std::string scene_text(const SceneSummary& scene) {
  const FeatureOptions& options = scene.options;
  std::string text;
  const auto line = [&text](const std::string& label, const std::string& value) {
    constexpr std::size_t kLabelWidth = 18;
    std::string padded = label;
    padded.resize(kLabelWidth, ' ');
    text += padded + cli::printable(value) + '\n';
  };
  line("name", scene.name);
  line("kind", std::string(kind_name(scene.kind)));
  line("state", scene.damage ? "damaged, not served: " + *scene.damage : "active");
  line("active version", std::to_string(scene.active_version));
  line("created", scene.created);
  line("points", cli::count_text(scene.points));
  line("keypoints",
       cli::count_text(scene.keypoints) + " (" +
           std::string(keypoint_method_name(options.keypoints)) + ", " +
           number_text(options.keypoint_spacing_m) + " m apart)");
  line("voxel", number_text(options.voxel_m) + " m");
  line("normal radius", number_text(options.normal_radius_m) + " m");
  line("descriptor radius", number_text(options.shot_radius_m) + " m");
  line("up", scene.up ? vector_text(*scene.up) : "not known");
  line("size", cli::bytes_text(scene.bytes));
  line("sources", joined(scene.sources));
  line("tags", tags_text(scene.tags));
  line("warnings", joined(scene.warnings));
  text += '\n' + versions_text(scene.versions);
  if (!scene.landmarks.empty()) text += '\n' + landmarks_text(scene.landmarks);
  return text;
}

}  // namespace landmarkdb::indexer
