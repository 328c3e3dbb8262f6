#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "datasets/depth_camera.hpp"
#include "datasets/generate/commands.hpp"
#include "datasets/picture/render_views.hpp"
#include "datasets/place_files.hpp"
#include "engine/cloud/merge_clouds.hpp"
#include "engine/cloud/read_cloud.hpp"
#include "engine/cloud/sanitise.hpp"

namespace landmarkdb::datasets {
namespace {

struct PictureArguments {
  std::vector<std::string> places, place_poses;
  std::string query, pose, out, up, title, place_label, query_label;
  std::string layout = "beside";
  int width_px = 1600;
  bool no_frustum = false;
};

PointCloud read_clean(const std::string& path) {
  PointCloud cloud = read_cloud(path, {});
  sanitise(cloud);
  return cloud;
}

PointCloud read_place(const PictureArguments& arguments) {
  if (arguments.places.size() == 1 && std::filesystem::is_directory(arguments.places[0])) {
    return read_place_set(arguments.places[0]);
  }
  if (!arguments.place_poses.empty() && arguments.place_poses.size() != arguments.places.size()) {
    throw cli::UsageError("--place-pose", "want none, or one for each --place in their order");
  }
  std::vector<PointCloud> clouds;
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t i = 0; i < arguments.places.size(); ++i) {
    clouds.push_back(read_clean(arguments.places[i]));
    poses.push_back(arguments.place_poses.empty() ? Eigen::Isometry3d::Identity()
                                                  : cli::read_pose(arguments.place_poses[i]));
  }
  return merge_clouds(clouds, poses);
}

std::string file_name(const std::string& path) {
  const std::filesystem::path p = std::filesystem::path(path).lexically_normal();
  return (p.has_filename() ? p.stem() : p.parent_path().filename()).string();
}

int run(const PictureArguments& arguments, const Generator& generator) {
  if (arguments.query.empty() != arguments.pose.empty()) {
    throw cli::UsageError(arguments.query.empty() ? "--query" : "--pose",
                          "--query and --pose belong together");
  }
  const PointCloud place = read_place(arguments);
  PointCloud query;
  Eigen::Isometry3d T_scene_sensor = Eigen::Isometry3d::Identity();
  ViewsOptions options;
  if (!arguments.query.empty()) {
    query = read_clean(arguments.query);
    T_scene_sensor = cli::read_pose(arguments.pose);
    if (!arguments.no_frustum) options.frustum = DepthCameraOptions().camera;
  }
  if (!arguments.up.empty()) options.up = cli::parse_direction(arguments.up, "--up");
  options.width_px = arguments.width_px;
  options.layout = arguments.layout == "stacked" ? Layout::kStacked : Layout::kBeside;
  options.title = arguments.title;
  options.place_label =
      arguments.place_label.empty() ? file_name(arguments.places.front()) : arguments.place_label;
  options.query_label =
      arguments.query_label.empty() ? file_name(arguments.query) : arguments.query_label;
  const Canvas canvas = render_views(place, query, T_scene_sensor, options);
  write_png(arguments.out, canvas);
  if (generator.json) {
    const nlohmann::ordered_json object = {
        {"picture", arguments.out}, {"width", canvas.width}, {"height", canvas.height}};
    std::cout << object.dump(2) << '\n';
  }
  return 0;
}

}  // namespace

void add_picture_command(CLI::App& app, Generator& generator) {
  const auto arguments = std::make_shared<PictureArguments>();
  CLI::App* command = cli::add_command(
      app,
      "picture",
      "Draw a place from above and from the side, with a query laid in by a pose, as PNG",
      {{"landmarkdb-generate picture --place lobby --query lobby/query-000.ply "
        "--pose lobby/query-000.pose.txt --out lobby.png",
        "a generated place with one of its queries"},
       {"landmarkdb-generate picture --place hall.ply --out hall.png", "a place by itself"}});
  cli::add_repeated(*command,
                    "--place",
                    arguments->places,
                    "A cloud in the scene frame, or a folder made by `place`; may be repeated")
      ->type_name("FILE")
      ->required();
  cli::add_repeated(*command,
                    "--place-pose",
                    arguments->place_poses,
                    "T_scene_cloud of each --place, 16 numbers (identity)")
      ->type_name("FILE");
  command->add_option("--query", arguments->query, "The query cloud, sensor frame")
      ->type_name("FILE");
  command->add_option("--pose", arguments->pose, "T_scene_sensor: a file of 16 numbers, or they")
      ->type_name("FILE");
  command->add_option("--out", arguments->out, "The picture")->type_name("FILE")->required();
  command->add_option("--layout", arguments->layout, "Where the side view goes (beside)")
      ->check(CLI::IsMember({"beside", "stacked"}));
  command->add_option("--width", arguments->width_px, "Width of the picture (1600)")
      ->type_name("PIXELS")
      ->check(CLI::Range(400, 8000));
  command->add_option("--title", arguments->title, "A line above the views")->type_name("TEXT");
  command->add_option("--place-label", arguments->place_label, "What the legend calls the place")
      ->type_name("TEXT");
  command->add_option("--query-label", arguments->query_label, "What the legend calls the query")
      ->type_name("TEXT");
  command->add_option("--up", arguments->up, "Direction against gravity in the scene (0,0,1)")
      ->type_name("X,Y,Z");
  command->add_flag("--no-frustum",
                    arguments->no_frustum,
                    "No field of view: the query is not from a depth camera");
  command->callback([arguments, &generator] {
    generator.action = [arguments, &generator] { return run(*arguments, generator); };
  });
}

}  // namespace landmarkdb::datasets
