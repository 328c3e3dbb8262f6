#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/Option.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "cli/usage_error.hpp"
#include "indexer/checked_names.hpp"
#include "indexer/commands.hpp"
#include "indexer/scene_view.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

using nlohmann::ordered_json;

const std::string kProgram = "landmarkdb-indexer --db site.db ";
const std::string kTagArgument = "KEY=VALUE";

int run_list(const Program& program) {
  const Store store = Store::open_read_only(program.database());
  const std::vector<SceneSummary> scenes = store.list_scenes();
  ordered_json array = ordered_json::array();
  for (const SceneSummary& scene : scenes) array.push_back(scene_json(scene, false));
  program.print({{"scenes", std::move(array)}, {"generation", store.generation()}},
                scenes_text(scenes));
  return 0;
}

int run_show(const std::string& name, const Program& program) {
  const SceneSummary scene = Store::open_read_only(program.database()).show(name);
  program.print(scene_json(scene, true), scene_text(scene));
  return 0;
}

int run_remove(const std::string& name, const Program& program) {
  Store::open_read_write(program.database()).remove(name);
  program.print({{"removed", name}}, "removed " + cli::printable(name) + "\n");
  return 0;
}

int run_rename(const std::string& from, const std::string& to, const Program& program) {
  require_name(to, "scene name", "NEW");
  Store::open_read_write(program.database()).rename(from, to);
  program.print({{"renamed", from}, {"scene", to}},
                "renamed " + cli::printable(from) + " to " + cli::printable(to) + "\n");
  return 0;
}

int run_rollback(const std::string& name, const Program& program) {
  const std::int64_t version = Store::open_read_write(program.database()).rollback(name);
  program.print({{"scene", name}, {"version", version}},
                cli::printable(name) + " is back at version " + std::to_string(version) + "\n");
  return 0;
}

// "KEY=VALUE"; the value may hold further '='. An empty one stands for no tag.
std::pair<std::string, std::optional<std::string>> parse_tag(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw cli::UsageError(kTagArgument,
                          '"' + cli::printable(text) + "\" is not a key, '=' and a value");
  }
  const std::string key = text.substr(0, equals);
  const std::string value = text.substr(equals + 1);
  require_name(key, "tag key", kTagArgument);
  require_tag_value(value, kTagArgument);
  if (value.empty()) return {key, std::nullopt};
  return {key, value};
}

int run_tag(const std::string& name,
            const std::vector<std::string>& texts,
            const Program& program) {
  TagChanges changes;
  for (const std::string& text : texts) {
    const auto [key, value] = parse_tag(text);
    changes[key] = value;
  }
  Store store = Store::open_read_write(program.database());
  store.change_tags(name, changes);
  const SceneSummary scene = store.show(name);
  std::string text;
  for (const auto& [key, value] : scene.tags) text += cli::printable(key + '=' + value) + '\n';
  program.print({{"scene", name}, {"tags", scene.tags}}, text);
  return 0;
}

// A command whose only argument is a scene's name.
void add_named(CLI::App& app,
               Program& program,
               const std::string& command_name,
               const std::string& description,
               int (*run)(const std::string&, const Program&)) {
  const auto name = std::make_shared<std::string>();
  CLI::App* command =
      cli::add_command(app, command_name, description, {{kProgram + command_name + " lobby", ""}});
  command->add_option("NAME", *name, "The scene")->type_name("")->required();
  command->callback([name, run, &program] {
    program.action = [name, run, &program] { return run(*name, program); };
  });
}

void add_list(CLI::App& app, Program& program) {
  CLI::App* command = cli::add_command(
      app,
      "list",
      "List the scenes",
      {{kProgram + "list", ""},
       {kProgram + "list --json | jq -r '.scenes[].name'", "their names, one a line"}});
  command->callback([&program] { program.action = [&program] { return run_list(program); }; });
}

void add_rename(CLI::App& app, Program& program) {
  const auto names = std::make_shared<std::pair<std::string, std::string>>();
  CLI::App* command = cli::add_command(
      app, "rename", "Give a scene another name", {{kProgram + "rename lobby entrance", ""}});
  command->add_option("OLD", names->first, "The scene")->type_name("")->required();
  command->add_option("NEW", names->second, "Its new name")->type_name("")->required();
  command->callback([names, &program] {
    program.action = [names, &program] { return run_rename(names->first, names->second, program); };
  });
}

void add_tag(CLI::App& app, Program& program) {
  struct Arguments {
    std::string name;
    std::vector<std::string> tags;
  };
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = cli::add_command(app,
                                       "tag",
                                       "Set tags of a scene; an empty value takes the tag away",
                                       {{kProgram + "tag lobby floor=2 building=north", ""},
                                        {kProgram + "tag lobby floor=", "without the tag"}});
  command->add_option("NAME", arguments->name, "The scene")->type_name("")->required();
  command->add_option("KEY=VALUE", arguments->tags, "Tags")->type_name("")->required();
  command->callback([arguments, &program] {
    program.action = [arguments, &program] {
      return run_tag(arguments->name, arguments->tags, program);
    };
  });
}

}  // namespace

void add_scene_commands(CLI::App& app, Program& program) {
  add_list(app, program);
  add_named(app, program, "show", "Show everything about a scene but its points", run_show);
  add_named(app, program, "remove", "Remove a scene with all its versions", run_remove);
  add_rename(app, program);
  add_named(app, program, "rollback", "Go back to a scene's version before this", run_rollback);
  add_tag(app, program);
}

}  // namespace landmarkdb::indexer
