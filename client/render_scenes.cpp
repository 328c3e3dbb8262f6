#include "client/render_scenes.hpp"

#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

#include "cli/table.hpp"
#include "client/choices.hpp"
#include "client/pose_values.hpp"

namespace landmarkdb::client {
namespace {

using cli::Align;
using Json = nlohmann::ordered_json;

Json landmark_json(const Landmark& landmark) {
  return {{"name", landmark.name},
          {"min_m", vector_json(landmark.min_m)},
          {"max_m", vector_json(landmark.max_m)}};
}

Json version_json(const SceneVersion& version) {
  Json out = {{"version", version.version},
              {"created", version.created},
              {"active", version.active},
              {"points", version.points},
              {"keypoints", version.keypoints},
              {"bytes", version.bytes}};
  if (!version.retired.empty()) out["retired"] = version.retired;
  if (!version.damage.empty()) out["damage"] = version.damage;
  return out;
}

std::string number_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string vector_text(const Eigen::Vector3d& v) {
  return number_text(v.x()) + ", " + number_text(v.y()) + ", " + number_text(v.z());
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text.empty() ? "-" : text;
}

std::string tags_text(const std::map<std::string, std::string>& tags) {
  std::vector<std::string> parts;
  for (const auto& [key, value] : tags) parts.push_back(key + '=' + value);
  return joined(parts);
}

std::string state_text(const SceneVersion& version) {
  std::string state = version.active ? "active" : "";
  if (!version.damage.empty())
    state += (state.empty() ? "" : ", ") + ("damaged: " + version.damage);
  return state;
}

std::string versions_text(const std::vector<SceneVersion>& versions) {
  cli::Table table({{"VERSION", Align::kRight},
                    {"CREATED"},
                    {"POINTS", Align::kRight},
                    {"KEYPOINTS", Align::kRight},
                    {"SIZE", Align::kRight},
                    {"STATE"}});
  for (const SceneVersion& version : versions) {
    table.add({std::to_string(version.version),
               version.created,
               cli::count_text(version.points),
               cli::count_text(version.keypoints),
               cli::bytes_text(version.bytes),
               state_text(version)});
  }
  return table.text();
}

std::string landmarks_text(const std::vector<Landmark>& landmarks) {
  cli::Table table({{"LANDMARK"}, {"MIN (m)"}, {"MAX (m)"}});
  for (const Landmark& landmark : landmarks) {
    table.add({landmark.name, vector_text(landmark.min_m), vector_text(landmark.max_m)});
  }
  return table.text();
}

}  // namespace

Json scene_json(const SceneInfo& scene) {
  Json out = {{"name", scene.name},
              {"scene_id", scene.scene_id},
              {"version", scene.version},
              {"kind", name_of(scene.kind)},
              {"state", scene.quarantined ? "quarantined" : "active"},
              {"points", scene.points},
              {"keypoints", scene.keypoints},
              {"bytes", scene.bytes},
              {"created", scene.created},
              {"options",
               {{"voxel_m", scene.options.voxel_m},
                {"normal_radius_m", scene.options.normal_radius_m},
                {"shot_radius_m", scene.options.shot_radius_m},
                {"keypoint_spacing_m", scene.options.keypoint_spacing_m},
                {"keypoints", name_of(scene.options.keypoints)}}},
              {"tags", Json(scene.tags)}};
  out["landmarks"] = Json::array();
  for (const Landmark& landmark : scene.landmarks) {
    out["landmarks"].push_back(landmark_json(landmark));
  }
  out["sources"] = scene.sources;
  out["warnings"] = scene.warnings;
  out["up"] = scene.up ? vector_json(*scene.up) : Json(nullptr);
  if (scene.min_m && scene.max_m) {
    out["min_m"] = vector_json(*scene.min_m);
    out["max_m"] = vector_json(*scene.max_m);
  }
  if (scene.quarantined) out["state_reason"] = scene.state_reason;
  if (!scene.versions.empty()) {
    out["versions"] = Json::array();
    for (const SceneVersion& version : scene.versions) {
      out["versions"].push_back(version_json(version));
    }
  }
  return out;
}

Json scenes_json(const std::vector<SceneInfo>& scenes) {
  Json list = Json::array();
  for (const SceneInfo& scene : scenes) list.push_back(scene_json(scene));
  return {{"scenes", std::move(list)}};
}

std::string scenes_text(const std::vector<SceneInfo>& scenes) {
  if (scenes.empty()) return "no scenes\n";
  cli::Table table({{"NAME"},
                    {"KIND"},
                    {"VERSION", Align::kRight},
                    {"POINTS", Align::kRight},
                    {"KEYPOINTS", Align::kRight},
                    {"SIZE", Align::kRight},
                    {"CREATED"},
                    {"STATE"}});
  for (const SceneInfo& scene : scenes) {
    table.add({scene.name,
               std::string(name_of(scene.kind)),
               std::to_string(scene.version),
               cli::count_text(scene.points),
               cli::count_text(scene.keypoints),
               cli::bytes_text(scene.bytes),
               scene.created,
               scene.quarantined ? "damaged" : "active"});
  }
  return table.text();
}

std::string scene_text(const SceneInfo& scene) {
  std::string text;
  const auto line = [&text](std::string label, const std::string& value) {
    constexpr std::size_t kLabelWidth = 18;
    label.resize(kLabelWidth, ' ');
    text += label + cli::printable(value) + '\n';
  };
  line("name", scene.name);
  line("kind", std::string(name_of(scene.kind)));
  line("state", scene.quarantined ? "damaged, not served: " + scene.state_reason : "active");
  line("active version", std::to_string(scene.version));
  line("created", scene.created);
  line("points", cli::count_text(scene.points));
  line("keypoints",
       cli::count_text(scene.keypoints) + " (" + std::string(name_of(scene.options.keypoints)) +
           ", " + number_text(scene.options.keypoint_spacing_m) + " m apart)");
  line("voxel", number_text(scene.options.voxel_m) + " m");
  line("descriptor radius", number_text(scene.options.shot_radius_m) + " m");
  if (scene.min_m && scene.max_m) {
    line("bounds", vector_text(*scene.min_m) + "  to  " + vector_text(*scene.max_m) + " m");
  }
  line("up", scene.up ? vector_text(*scene.up) : "not known");
  line("size", cli::bytes_text(scene.bytes));
  line("sources", joined(scene.sources));
  line("tags", tags_text(scene.tags));
  line("warnings", joined(scene.warnings));
  if (!scene.versions.empty()) text += '\n' + versions_text(scene.versions);
  if (!scene.landmarks.empty()) text += '\n' + landmarks_text(scene.landmarks);
  return text;
}

}  // namespace landmarkdb::client
