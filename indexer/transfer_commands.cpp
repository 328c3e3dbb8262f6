#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/Option.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "engine/retrieval/scene_index.hpp"
#include "indexer/add_model.hpp"
#include "indexer/checked_names.hpp"
#include "indexer/commands.hpp"
#include "indexer/long_job.hpp"
#include "indexer/new_database.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

const std::string kProgram = "landmarkdb-indexer --db site.db ";

struct TransferArguments {
  std::string name;
  std::string file;
  bool model = false;
};

int run_backup(const TransferArguments& arguments, const Program& program) {
  LongJob job(program);
  Store::open_read_only(program.database()).backup(arguments.file, job.context());
  job.finish_progress();
  program.print({{"backup", arguments.file}}, "backed up to " + arguments.file + "\n");
  return 0;
}

// A scene and a model may have one name; then the scene is meant, unless --model says otherwise.
int run_export(const TransferArguments& arguments, const Program& program) {
  LongJob job(program);
  const Store store = Store::open_read_only(program.database());
  const std::vector<ModelSummary> models = store.list_models();
  const bool has_model = std::any_of(models.begin(), models.end(), [&](const ModelSummary& model) {
    return model.name == arguments.name;
  });
  const bool as_model = arguments.model || (has_model && !store.find_scene(arguments.name));
  if (as_model) {
    export_model(store, arguments.name, arguments.file);
  } else {
    store.export_scene(arguments.name, arguments.file, job.context());
  }
  job.finish_progress();
  program.print({{as_model ? "model" : "scene", arguments.name}, {"file", arguments.file}},
                "exported " + cli::printable(arguments.name) + " to " + arguments.file + "\n");
  return 0;
}

// What export writes of a scene begins so; anything else is read as a model.
bool is_scene_file(const std::string& path) {
  constexpr std::string_view kMagic = "LMDKSCN\n";
  std::string begin(kMagic.size(), '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == kMagic;
}

bool looks_like_model(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  char first = 0;
  stream >> first;
  return first == '{';
}

int import_model(const TransferArguments& arguments, const Program& program) {
  LongJob job(program);
  const AddModelResult added =
      add_model({arguments.name, arguments.file, {}}, program.database(), job.context());
  job.finish_progress();
  for (const std::string& warning : added.summary.warnings) program.note("note: " + warning);
  program.print({{"model", added.summary.name},
                 {"model_id", added.summary.id},
                 {"replaced", added.stored.replaced}},
                "imported model " + cli::printable(added.summary.name) + "\n");
  return 0;
}

int run_import(const TransferArguments& arguments, const Program& program) {
  const std::string& db = program.database();
  std::optional<std::string> as_name;
  if (!arguments.name.empty()) as_name = arguments.name;
  if (as_name) require_name(*as_name, "scene name", "--as");
  if (!is_scene_file(arguments.file) && looks_like_model(arguments.file)) {
    return import_model(arguments, program);
  }
  LongJob job(program);
  require_writable_database(db);
  std::string name;
  const InsertResult stored = change_or_create(db, [&](Store& store) {
    const InsertResult result = store.import_scene(
        arguments.file, job.context(), as_name, {make_scene_index, scene_index_format()});
    for (const SceneSummary& scene : store.list_scenes()) {
      if (scene.id == result.scene_id) name = scene.name;
    }
    return result;
  });
  job.finish_progress();
  program.print(
      {{"scene", name}, {"scene_id", stored.scene_id}, {"version", stored.version}},
      "imported " + cli::printable(name) + " version " + std::to_string(stored.version) + "\n");
  return 0;
}

using Run = int (*)(const TransferArguments&, const Program&);

CLI::App* add_sub(CLI::App& app,
                  Program& program,
                  const std::shared_ptr<TransferArguments>& arguments,
                  const std::string& name,
                  const std::string& description,
                  const std::string& example,
                  Run run) {
  CLI::App* command = cli::add_command(app, name, description, {{kProgram + example, ""}});
  command->callback([arguments, run, &program] {
    program.action = [arguments, run, &program] { return run(*arguments, program); };
  });
  return command;
}

}  // namespace

void add_transfer_commands(CLI::App& app, Program& program) {
  const auto arguments = std::make_shared<TransferArguments>();
  CLI::App* backup = add_sub(app,
                             program,
                             arguments,
                             "backup",
                             "Write a consistent copy of the database, also while others use it",
                             "backup site-copy.db",
                             run_backup);
  backup->add_option("FILE", arguments->file, "The copy; must not exist")
      ->type_name("")
      ->required();

  CLI::App* export_command = add_sub(app,
                                     program,
                                     arguments,
                                     "export",
                                     "Write one scene or model as a portable file",
                                     "export lobby lobby.scene",
                                     run_export);
  export_command->add_option("NAME", arguments->name, "The scene or model")
      ->type_name("")
      ->required();
  export_command->add_option("FILE", arguments->file, "The file; must not exist")
      ->type_name("")
      ->required();

  export_command->add_flag(
      "--model", arguments->model, "NAME is a model, even where a scene is called so too");

  CLI::App* import_command =
      add_sub(app,
              program,
              arguments,
              "import",
              "Store a scene or model that export wrote; a scene's name that "
              "exists gets a new version, a model's is replaced",
              "import lobby.scene",
              run_import);
  import_command->add_option("FILE", arguments->file, "The file")->type_name("")->required();
  import_command->add_option("--as", arguments->name, "Store it under this name")
      ->type_name("NAME");
}

}  // namespace landmarkdb::indexer
