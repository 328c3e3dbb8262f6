#include <map>
#include <memory>
#include <utility>
#include <vector>

#include <CLI/Option.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "cli/usage_error.hpp"
#include "cli/values.hpp"
#include "client/render_scenes.hpp"
#include "client/request_command.hpp"
#include "client/scene_add.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

// A request that answers with the scene as it is now.
template <typename Request>
void on_scene_request(CLI::App& command, Program& program, Request request) {
  on_request(command, program, std::move(request), [&program](const SceneInfo& scene) {
    program.print(scene_json(scene), scene_text(scene));
  });
}

void add_list(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent, "list", "List the scenes that are served", {{"landmarkdb scene list", ""}});
  on_request(
      *command,
      program,
      [](Session& session) { return session.connect().scenes(session.context()); },
      [&program](const std::vector<SceneInfo>& scenes) {
        program.print(scenes_json(scenes), scenes_text(scenes));
      });
}

void add_show(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(parent,
                                       "show",
                                       "Show one scene, its versions and landmarks",
                                       {{"landmarkdb scene show lobby", ""}});
  const auto name = add_name(*command, "scene");
  on_scene_request(*command, program, [name](Session& session) {
    return session.connect().scene(*name, session.context());
  });
}

void add_add(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent,
      "add",
      "Send scans of a place to be described, stored and served",
      {{"landmarkdb scene add lobby lobby.ply --viewpoint 0,0,1.6", "one scan"},
       {"landmarkdb scene add yard a.pcd b.pcd --pose a.txt --pose b.txt", "two, with poses"}});
  const auto arguments = std::make_shared<SceneAddArguments>();
  add_scene_add_options(*command, *arguments);
  on_scene_request(*command, program, [arguments](Session& session) {
    const SceneAdd add = load_scene(*arguments);
    return session.connect().add_scene(add, session.context());
  });
}

void add_remove(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(parent,
                                       "remove",
                                       "Remove a scene with all its versions",
                                       {{"landmarkdb scene remove lobby", ""}});
  const auto name = add_name(*command, "scene");
  on_request(
      *command,
      program,
      [name](Session& session) {
        session.connect().remove_scene(*name, session.context());
        return *name;
      },
      [&program](const std::string& removed) {
        program.print(Json{{"removed", removed}}, "removed " + cli::printable(removed) + "\n");
      });
}

void add_rename(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent, "rename", "Rename a scene", {{"landmarkdb scene rename lobby entrance", ""}});
  const auto names = add_renaming(*command, "scene");
  on_scene_request(*command, program, [names](Session& session) {
    return session.connect().rename_scene(names->from, names->to, session.context());
  });
}

void add_rollback(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(parent,
                                       "rollback",
                                       "Serve the version before the active one again",
                                       {{"landmarkdb scene rollback lobby", ""}});
  const auto name = add_name(*command, "scene");
  on_scene_request(*command, program, [name](Session& session) {
    return session.connect().rollback_scene(*name, session.context());
  });
}

std::map<std::string, std::string> parse_tags(const std::vector<std::string>& words) {
  std::map<std::string, std::string> tags;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos) {
      throw cli::UsageError("KEY=VALUE", "'" + word + "' is no KEY=VALUE");
    }
    tags[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return tags;
}

void add_tag(CLI::App& parent, Program& program) {
  CLI::App* command =
      cli::add_command(parent,
                       "tag",
                       "Set tags of a scene; an empty value takes one away",
                       {{"landmarkdb scene tag lobby floor=2 owner=", "set one, take one away"}});
  const auto name = std::make_shared<std::string>();
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("NAME", *name, "Name of the scene")->required();
  command->add_option("KEY=VALUE", *words, "Tags")->required();
  on_scene_request(*command, program, [name, words](Session& session) {
    const std::map<std::string, std::string> tags = parse_tags(*words);
    return session.connect().tag_scene(*name, tags, session.context());
  });
}

void add_landmark_commands(CLI::App& parent, Program& program) {
  CLI::App* group = cli::add_command(
      parent,
      "landmark",
      "Name parts of a scene",
      {{"landmarkdb scene landmark add lobby desk --box 1,2,0,2,3,1.2", "axis-aligned, metres"}});
  group->require_subcommand(1);

  CLI::App* add = cli::add_command(*group, "add", "Name a box of a scene", {});
  const auto scene = std::make_shared<std::string>();
  const auto landmark = std::make_shared<std::string>();
  const auto box = std::make_shared<std::string>();
  add->add_option("SCENE", *scene, "Name of the scene")->required();
  add->add_option("LANDMARK", *landmark, "Name of the landmark")->required();
  add->add_option("--box", *box, "Its box in the scene frame, metres")
      ->type_name("xmin,ymin,zmin,xmax,ymax,zmax")
      ->required();
  on_scene_request(*add, program, [scene, landmark, box](Session& session) {
    const cli::Box bounds = cli::parse_box(*box, "--box");
    return session.connect().add_landmark(
        *scene,
        {.name = *landmark, .min_m = bounds.min_m, .max_m = bounds.max_m},
        session.context());
  });

  CLI::App* remove = cli::add_command(*group, "remove", "Take a landmark's name away", {});
  remove->add_option("SCENE", *scene, "Name of the scene")->required();
  remove->add_option("LANDMARK", *landmark, "Name of the landmark")->required();
  on_scene_request(*remove, program, [scene, landmark](Session& session) {
    return session.connect().remove_landmark(*scene, *landmark, session.context());
  });
}

}  // namespace

void add_scene_commands(CLI::App& app, Program& program) {
  CLI::App* group =
      cli::add_command(app,
                       "scene",
                       "List, show and change the scenes of the server",
                       {{"landmarkdb scene list", ""}, {"landmarkdb scene show lobby --json", ""}});
  group->require_subcommand(1);
  add_list(*group, program);
  add_show(*group, program);
  add_add(*group, program);
  add_remove(*group, program);
  add_rename(*group, program);
  add_rollback(*group, program);
  add_tag(*group, program);
  add_landmark_commands(*group, program);
}

}  // namespace landmarkdb::client
