#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/model_view.hpp"
#include "cli/table.hpp"
#include "indexer/add_model.hpp"
#include "indexer/checked_names.hpp"
#include "indexer/commands.hpp"
#include "indexer/long_job.hpp"
#include "indexer/model_view.hpp"
#include "indexer/units_hint.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

using nlohmann::ordered_json;

const std::string kProgram = "landmarkdb-indexer --db site.db model ";

struct ModelArguments {
  std::string name;
  std::string file;
  std::string units;
  std::string new_name;
};

int run_add(const ModelArguments& arguments, const Program& program) {
  require_name(arguments.name, "model name", "NAME");
  AddModelRequest request{arguments.name, arguments.file, {}};
  if (!arguments.units.empty()) request.options.units = parse_units(arguments.units);
  const std::string& db = program.database();
  LongJob job(program);
  const AddModelResult added = add_model(request, db, job.context());
  job.finish_progress();
  for (const std::string& warning : added.summary.warnings) program.note("note: " + warning);
  ordered_json object = cli::model_json(added.summary);
  object["replaced"] = added.stored.replaced;
  program.print(object,
                (added.stored.replaced ? "replaced model " : "added model ") +
                    cli::printable(arguments.name) + ": " + cli::model_figures(added.summary) +
                    "\n");
  return 0;
}

int run_remove(const ModelArguments& arguments, const Program& program) {
  Store::open_read_write(program.database()).remove_model(arguments.name);
  program.print({{"removed", arguments.name}},
                "removed model " + cli::printable(arguments.name) + "\n");
  return 0;
}

int run_rename(const ModelArguments& arguments, const Program& program) {
  require_name(arguments.new_name, "model name", "NEW");
  Store::open_read_write(program.database()).rename_model(arguments.name, arguments.new_name);
  program.print({{"renamed", arguments.name}, {"model", arguments.new_name}},
                "renamed model " + cli::printable(arguments.name) + " to " +
                    cli::printable(arguments.new_name) + "\n");
  return 0;
}

int run_list(const ModelArguments&, const Program& program) {
  const Store store = Store::open_read_only(program.database());
  const std::vector<ModelSummary> models = store.list_models();
  ordered_json array = ordered_json::array();
  for (const ModelSummary& model : models) array.push_back(cli::model_json(model));
  program.print({{"models", std::move(array)}, {"generation", store.generation()}},
                cli::models_text(models));
  return 0;
}

int run_show(const ModelArguments& arguments, const Program& program) {
  const Store store = Store::open_read_only(program.database());
  const ModelSummary summary = store.show_model(arguments.name);
  const auto record = store.load_model(arguments.name);
  program.print(model_json(summary, record->model), model_text(summary, record->model));
  return 0;
}

using Run = int (*)(const ModelArguments&, const Program&);

CLI::App* add_sub(CLI::App& parent,
                  Program& program,
                  const std::string& name,
                  const std::string& description,
                  const std::vector<cli::Example>& examples,
                  const std::shared_ptr<ModelArguments>& arguments,
                  Run run) {
  CLI::App* command = cli::add_command(parent, name, description, examples);
  command->callback([arguments, run, &program] {
    program.action = [arguments, run, &program] { return run(*arguments, program); };
  });
  return command;
}

void add_name(CLI::App& command, const std::shared_ptr<ModelArguments>& arguments) {
  command.add_option("NAME", arguments->name, "The model")->type_name("")->required();
}

void add_add(CLI::App& parent, Program& program) {
  const auto arguments = std::make_shared<ModelArguments>();
  CLI::App* add = add_sub(
      parent,
      program,
      "add",
      "Read a model, derive its edges, points, triples and symmetries, and store it; a model of "
      "that "
      "name is replaced",
      {{kProgram + "add box box.json", "points, edges, faces, circles as JSON"},
       {kProgram + "add crate crate.obj --units mm", "a polyhedron: flat faces, edges and corners"},
       {kProgram + "add cube cube.cao", "a ViSP CAD model"}},
      arguments,
      run_add);
  add->add_option("NAME", arguments->name, "Name to store it under")->type_name("")->required();
  add->add_option(
         "FILE", arguments->file, "Model: .json, .cao (ViSP), or an .obj or .ply polyhedron")
      ->type_name("")
      ->required();
  add->add_option("--units", arguments->units, "Unit of the file's lengths [its own, else m]")
      ->check(CLI::IsMember({"m", "mm", "cm", "inch"}));
}

}  // namespace

void add_model_commands(CLI::App& app, Program& program) {
  CLI::App* parent =
      cli::add_command(app,
                       "model",
                       "Keep the models that `recognize` finds in images",
                       {{kProgram + "add box box.json", ""}, {kProgram + "list", ""}});
  parent->require_subcommand(1);
  add_add(*parent, program);

  const auto removed = std::make_shared<ModelArguments>();
  add_name(*add_sub(*parent,
                    program,
                    "remove",
                    "Remove a model",
                    {{kProgram + "remove box", ""}},
                    removed,
                    run_remove),
           removed);

  const auto renamed = std::make_shared<ModelArguments>();
  CLI::App* rename = add_sub(*parent,
                             program,
                             "rename",
                             "Give a model another name",
                             {{kProgram + "rename box parcel", ""}},
                             renamed,
                             run_rename);
  rename->add_option("OLD", renamed->name, "The model")->type_name("")->required();
  rename->add_option("NEW", renamed->new_name, "Its new name")->type_name("")->required();

  add_sub(*parent,
          program,
          "list",
          "List the models",
          {{kProgram + "list", ""},
           {kProgram + "list --json | jq -r '.models[].name'", "their names, one a line"}},
          std::make_shared<ModelArguments>(),
          run_list);

  const auto shown = std::make_shared<ModelArguments>();
  add_name(*add_sub(*parent,
                    program,
                    "show",
                    "Show a model with all its points",
                    {{kProgram + "show box", ""},
                     {kProgram + "show box --json | jq .model.symmetries", "what is derived too"}},
                    shown,
                    run_show),
           shown);
}

}  // namespace landmarkdb::indexer
