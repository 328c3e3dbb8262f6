#include <memory>
#include <string>

#include <CLI/Option.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "cli/values.hpp"
#include "indexer/checked_names.hpp"
#include "indexer/commands.hpp"
#include "indexer/scene_view.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

const std::string kProgram = "landmarkdb-indexer --db site.db landmark ";

struct LandmarkArguments {
  std::string scene;
  std::string landmark;
  std::string box;
};

int run_add(const LandmarkArguments& arguments, const Program& program) {
  require_name(arguments.landmark, "landmark name", "LANDMARK");
  const cli::Box box = cli::parse_box(arguments.box, "--box");
  const Landmark landmark{arguments.landmark, box.min_m, box.max_m};
  Store::open_read_write(program.database()).add_landmark(arguments.scene, landmark);
  program.print({{"scene", arguments.scene}, {"landmark", landmark_json(landmark)}},
                "added landmark " + cli::printable(landmark.name) + " to " +
                    cli::printable(arguments.scene) + "\n");
  return 0;
}

int run_remove(const LandmarkArguments& arguments, const Program& program) {
  Store::open_read_write(program.database()).remove_landmark(arguments.scene, arguments.landmark);
  program.print({{"scene", arguments.scene}, {"removed", arguments.landmark}},
                "removed landmark " + cli::printable(arguments.landmark) + " from " +
                    cli::printable(arguments.scene) + "\n");
  return 0;
}

int run_list(const LandmarkArguments& arguments, const Program& program) {
  const auto landmarks = Store::open_read_only(program.database()).list_landmarks(arguments.scene);
  program.print({{"scene", arguments.scene}, {"landmarks", landmarks_json(landmarks)}},
                landmarks_text(landmarks));
  return 0;
}

using Run = int (*)(const LandmarkArguments&, const Program&);

// The parser of one of the three, with the scene as its first argument.
CLI::App* add_sub(CLI::App& parent,
                  Program& program,
                  const std::shared_ptr<LandmarkArguments>& arguments,
                  const std::string& name,
                  const std::string& description,
                  const std::string& example,
                  Run run) {
  CLI::App* command = cli::add_command(parent, name, description, {{kProgram + example, ""}});
  command->add_option("SCENE", arguments->scene, "The scene")->type_name("")->required();
  command->callback([arguments, run, &program] {
    program.action = [arguments, run, &program] { return run(*arguments, program); };
  });
  return command;
}

void add_landmark_name(CLI::App& command, const std::shared_ptr<LandmarkArguments>& arguments) {
  command.add_option("LANDMARK", arguments->landmark, "The landmark")->type_name("")->required();
}

}  // namespace

void add_landmark_commands(CLI::App& app, Program& program) {
  const auto arguments = std::make_shared<LandmarkArguments>();
  CLI::App* parent =
      cli::add_command(app,
                       "landmark",
                       "Name parts of a scene, so that answers can say which part was seen",
                       {{kProgram + "list lobby", ""}});
  parent->require_subcommand(1);

  CLI::App* add = add_sub(*parent,
                          program,
                          arguments,
                          "add",
                          "Name a box of a scene; a landmark of that name is replaced",
                          "add lobby air-vents --box 0,0,2,4.5,1,3",
                          run_add);
  add_landmark_name(*add, arguments);
  add->add_option("--box", arguments->box, "Lower and upper corner in the scene's frame, metres")
      ->type_name("XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX")
      ->required();

  CLI::App* remove = add_sub(*parent,
                             program,
                             arguments,
                             "remove",
                             "Remove a landmark",
                             "remove lobby air-vents",
                             run_remove);
  add_landmark_name(*remove, arguments);

  add_sub(*parent, program, arguments, "list", "List a scene's landmarks", "list lobby", run_list);
}

}  // namespace landmarkdb::indexer
