#include "client/scene_add.hpp"

#include <filesystem>
#include <utility>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "client/choices.hpp"
#include "client/load_cloud.hpp"

namespace landmarkdb::client {

void add_scene_add_options(CLI::App& command, SceneAddArguments& a) {
  command.add_option("NAME", a.name, "Name of the scene; one that exists gets a new version")
      ->required();
  command.add_option("CLOUD", a.clouds, "Scans of the place, read here and sent to the server")
      ->required();
  command.add_option("--kind", a.kind, "place: a query sees a part of it; object: the reverse")
      ->check(CLI::IsMember(kKindNames))
      ->capture_default_str();
  cli::add_repeated(command, "--pose", a.poses, "Pose of each cloud in the scene frame [identity]")
      ->type_name("FILE");
  cli::add_repeated(command,
                    "--viewpoint",
                    a.viewpoints,
                    "Where each cloud was scanned from, in its own frame and units [the file's]")
      ->type_name("x,y,z");
  command.add_option("--keypoints", a.keypoints, "Keypoint detector [structure]")
      ->check(CLI::IsMember(kKeypointNames));
  command.add_option("--voxel", a.voxel, "Working resolution in metres [from the data]")
      ->type_name("M");
  command.add_option("--radius", a.radius, "Descriptor radius in metres [from the data]")
      ->type_name("M");
  command.add_option("--up", a.up, "Direction against gravity, scene frame")->type_name("x,y,z");
  command.add_option("--units", a.units, "Unit of the clouds' coordinates")
      ->check(CLI::IsMember(kUnitNames))
      ->capture_default_str();
}

SceneAdd load_scene(const SceneAddArguments& a) {
  check_one_each("--pose", a.poses.size(), a.clouds.size());
  check_one_each("--viewpoint", a.viewpoints.size(), a.clouds.size());
  SceneAdd add;
  add.name = a.name;
  add.kind = a.kind == "object" ? EntryKind::kObject : EntryKind::kPlace;
  if (!a.voxel.empty()) add.voxel_m = cli::parse_positive(a.voxel, "--voxel");
  if (!a.radius.empty()) add.radius_m = cli::parse_positive(a.radius, "--radius");
  if (!a.keypoints.empty()) add.keypoints = keypoint_method(a.keypoints, "--keypoints");
  if (!a.up.empty()) add.up = cli::parse_direction(a.up, "--up");
  for (std::size_t i = 0; i < a.clouds.size(); ++i) {
    SceneScan scan;
    LoadOptions load{.units = a.units, .camera = {}, .viewpoint = {}};
    if (!a.viewpoints.empty()) {
      load.viewpoint = cli::parse_vector3(a.viewpoints[i], "--viewpoint");
    }
    if (!a.poses.empty()) scan.T_scene_cloud = cli::read_pose_file(a.poses[i]);
    scan.cloud = load_cloud(a.clouds[i], load);
    scan.source = std::filesystem::path(a.clouds[i]).filename().string();
    add.scans.push_back(std::move(scan));
  }
  return add;
}

}  // namespace landmarkdb::client
