#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "indexer/add_scene.hpp"
#include "indexer/checked_names.hpp"
#include "indexer/commands.hpp"
#include "indexer/long_job.hpp"
#include "indexer/scene_view.hpp"
#include "indexer/units_hint.hpp"

namespace landmarkdb::indexer {
namespace {

using nlohmann::ordered_json;

// As typed.
struct AddArguments {
  std::string name;
  std::vector<std::string> clouds;
  std::string kind = "place";
  std::vector<std::string> poses;
  std::vector<std::string> viewpoints;
  std::string keypoints = "structure";
  std::string voxel, radius, up;
  std::string units = "m";
  bool estimate = false;
};

KeypointMethod parse_keypoints(const std::string& name) {
  for (const KeypointMethod method : {KeypointMethod::kUniform,
                                      KeypointMethod::kStructure,
                                      KeypointMethod::kIss,
                                      KeypointMethod::kNarf}) {
    if (keypoint_method_name(method) == name) return method;
  }
  throw cli::UsageError("--keypoints", '"' + name + "\" is not a keypoint method");
}

// Once a cloud or not at all.
void require_one_each(const std::string& option, std::size_t given, std::size_t clouds) {
  if (given == 0 || given == clouds) return;
  throw cli::UsageError(option,
                        "given " + cli::counted(given, "time") + " for " +
                            cli::counted(clouds, "cloud") +
                            "; want none, or one for each cloud in their order");
}

AddRequest request_of(const AddArguments& arguments) {
  require_name(arguments.name, "scene name", "NAME");
  require_one_each("--pose", arguments.poses.size(), arguments.clouds.size());
  require_one_each("--viewpoint", arguments.viewpoints.size(), arguments.clouds.size());
  AddRequest request;
  request.name = arguments.name;
  request.clouds = arguments.clouds;
  request.units = parse_units(arguments.units);
  request.options.kind = arguments.kind == "object" ? EntryKind::kObject : EntryKind::kPlace;
  request.options.keypoints = parse_keypoints(arguments.keypoints);
  if (!arguments.voxel.empty()) {
    request.options.voxel_m = cli::parse_positive(arguments.voxel, "--voxel");
  }
  if (!arguments.radius.empty()) {
    request.options.radius_m = cli::parse_positive(arguments.radius, "--radius");
  }
  if (!arguments.up.empty()) request.options.up = cli::parse_direction(arguments.up, "--up");
  for (const std::string& viewpoint : arguments.viewpoints) {
    request.viewpoints.push_back(cli::parse_vector3(viewpoint, "--viewpoint") *
                                 metres_per(request.units));
  }
  for (const std::string& pose : arguments.poses) {
    request.poses.push_back(cli::read_pose_file(pose));
  }
  return request;
}

std::string seconds_text(double seconds) {
  char text[40];
  std::snprintf(text, sizeof text, seconds < 10.0 ? "%.1f s" : "%.0f s", seconds);
  return text;
}

std::string metres_text(double metres) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g m", metres);
  return text;
}

int print_estimate(const AddRequest& request, const Program& program) {
  LongJob job(program);
  const auto start = std::chrono::steady_clock::now();
  GatheredScans scans = gather_scans(request, job.context());
  const std::chrono::duration<double> gathering = std::chrono::steady_clock::now() - start;
  IndexEstimate estimate = estimate_index(std::move(scans), request.options, job.context());
  estimate.seconds += gathering.count();
  job.finish_progress();
  const ordered_json object = {{"scene", request.name},
                               {"estimate", true},
                               {"options", options_json(estimate.options)},
                               {"points", estimate.points},
                               {"points_used", estimate.points_used},
                               {"keypoints", estimate.keypoints},
                               {"database_bytes", estimate.database_bytes},
                               {"memory_bytes", estimate.memory_bytes},
                               {"served_bytes", estimate.served_bytes},
                               {"seconds", estimate.seconds}};
  const FeatureOptions& options = estimate.options;
  const std::string text =
      "points             " + cli::count_text(estimate.points) + " given, about " +
      cli::count_text(estimate.points_used) + " after thinning\n" + "keypoints          about " +
      cli::count_text(estimate.keypoints) + " (" +
      std::string(keypoint_method_name(options.keypoints)) + ", " +
      metres_text(options.keypoint_spacing_m) + " apart)\n" + "voxel              " +
      metres_text(options.voxel_m) + "\n" + "normal radius      " +
      metres_text(options.normal_radius_m) + "\n" + "descriptor radius  " +
      metres_text(options.shot_radius_m) + "\n" + "database           about " +
      cli::bytes_text(estimate.database_bytes) + "\n" + "memory             about " +
      cli::bytes_text(estimate.memory_bytes) + " to index, " +
      cli::bytes_text(estimate.served_bytes) + " in a server\n" + "time               about " +
      seconds_text(estimate.seconds) + "\n";
  program.print(object, text);
  return 0;
}

void tell_warnings(const SceneRecord& record, Units units, const Program& program) {
  for (const std::string& warning : record.warnings) {
    if (warning == "units_suspect") {
      program.note(units_hint(extent_of(record.prepared.points), units, record.kind));
    } else {
      program.note("warning: " + warning);
    }
  }
}

ordered_json result_json(const AddResult& result, Units units, double seconds) {
  const SceneRecord& record = result.record;
  ordered_json object = {{"scene", record.name},
                         {"scene_id", result.stored.scene_id},
                         {"version", result.stored.version},
                         {"kind", kind_name(record.kind)},
                         {"points", record.prepared.counts.points},
                         {"points_used", record.prepared.size()},
                         {"invalid", record.prepared.counts.invalid()},
                         {"keypoints", record.descriptors.size()},
                         {"options", options_json(record.options)},
                         {"sources", record.sources},
                         {"warnings", record.warnings},
                         {"generation", result.stored.generation},
                         {"seconds", seconds},
                         {"units_guess", nullptr}};
  for (const std::string& warning : record.warnings) {
    if (warning != "units_suspect") continue;
    const auto guess = guess_units(extent_of(record.prepared.points), units, record.kind);
    object["units_guess"] = guess ? ordered_json(units_name(*guess)) : ordered_json(nullptr);
  }
  return object;
}

int run_add(const AddArguments& arguments, const Program& program) {
  const AddRequest request = request_of(arguments);
  if (arguments.estimate) return print_estimate(request, program);
  const std::string& db = program.database();
  const auto start = std::chrono::steady_clock::now();
  LongJob job(program);
  const AddResult result = add_scene(request, db, job.context());
  job.finish_progress();
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  tell_warnings(result.record, request.units, program);
  const SceneRecord& record = result.record;
  program.print(result_json(result, request.units, elapsed.count()),
                "added " + record.name + " version " + std::to_string(result.stored.version) +
                    ": " + cli::count_text(record.prepared.counts.points) + " points, " +
                    cli::count_text(record.prepared.size()) + " kept at " +
                    metres_text(record.options.voxel_m) + ", " +
                    cli::count_text(record.descriptors.size()) + " keypoints, " +
                    seconds_text(elapsed.count()) + "\n");
  return 0;
}

}  // namespace

void add_add_command(CLI::App& app, Program& program) {
  const auto arguments = std::make_shared<AddArguments>();
  CLI::App* command = cli::add_command(
      app,
      "add",
      "Describe a scan and store it; several files of one place are one scene. A name that exists "
      "gets a new version, activated once it is whole",
      {{"landmarkdb-indexer --db site.db add lobby lobby.ply", ""},
       {"landmarkdb-indexer --db site.db add lobby a.pcd b.pcd --pose a.txt --pose b.txt",
        "two scans with their poses in the scene's frame, 16 numbers each"},
       {"landmarkdb-indexer --db parts.db add valve valve.stl --kind object --units mm", ""},
       {"landmarkdb-indexer add lobby lobby.ply --estimate",
        "what it would take, without touching a database"}});
  command->add_option("NAME", arguments->name, "Name of the place or object")
      ->type_name("")
      ->required();
  command
      ->add_option("CLOUD", arguments->clouds, "Scans: PCD, PLY, XYZ, PTS, or meshes OBJ, STL, PLY")
      ->type_name("")
      ->required();
  command
      ->add_option("--kind",
                   arguments->kind,
                   "place: a query sees a part of it (default); object: the query's scene holds it")
      ->check(CLI::IsMember({"place", "object"}));
  cli::add_repeated(*command,
                    "--pose",
                    arguments->poses,
                    "File with the pose of a cloud in the scene's frame, one for each cloud: 4x4, "
                    "row-major; identity if left out")
      ->type_name("FILE");
  cli::add_repeated(*command,
                    "--viewpoint",
                    arguments->viewpoints,
                    "Where a cloud was scanned from, in its own frame and units, one for each "
                    "cloud; instead of what the file says")
      ->type_name("X,Y,Z");
  command->add_option("--keypoints", arguments->keypoints, "How keypoints are chosen (structure)")
      ->check(CLI::IsMember({"structure", "uniform", "iss", "narf"}));
  command
      ->add_option(
          "--voxel", arguments->voxel, "Working resolution; derived from the scan if left out")
      ->type_name("METRES");
  command
      ->add_option(
          "--radius", arguments->radius, "Descriptor radius; derived from the scan if left out")
      ->type_name("METRES");
  command->add_option("--up", arguments->up, "Direction against gravity in the scene's frame")
      ->type_name("X,Y,Z");
  command->add_option("--units", arguments->units, "Units of the files' coordinates (m)")
      ->check(CLI::IsMember({"m", "mm", "cm", "inch"}));
  command->add_flag("--estimate",
                    arguments->estimate,
                    "Only say what it would take: options, keypoints, bytes, seconds");
  command->callback([arguments, &program] {
    program.action = [arguments, &program] { return run_add(*arguments, program); };
  });
}

}  // namespace landmarkdb::indexer
