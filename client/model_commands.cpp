#include <filesystem>
#include <memory>
#include <utility>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/model_view.hpp"
#include "cli/table.hpp"
#include "client/choices.hpp"
#include "client/render_recognition.hpp"
#include "client/request_command.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxModelBytes = std::uint64_t{64} << 20U;

// A request that answers with the model as it is now.
template <typename Request>
void on_model_request(CLI::App& command, Program& program, Request request) {
  on_request(command, program, std::move(request), [&program](const ModelInfo& model) {
    Json json = model_json(model);
    if (model.replaced) json["replaced"] = true;
    program.print(json, cli::model_text(model.summary));
  });
}

void add_list(CLI::App& parent, Program& program) {
  CLI::App* command =
      cli::add_command(parent, "list", "List the models", {{"landmarkdb model list", ""}});
  on_request(
      *command,
      program,
      [](Session& session) { return session.connect().models(session.context()); },
      [&program](const std::vector<ModelSummary>& models) {
        program.print(models_json(models), cli::models_text(models));
      });
}

void add_show(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent,
      "show",
      "Show one model; with --json its points, edges, faces, circles and symmetries too",
      {{"landmarkdb model show box --json", ""}});
  const auto name = add_name(*command, "model");
  on_model_request(*command, program, [name](Session& session) {
    return session.connect().model(*name, session.context());
  });
}

void add_add(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent,
      "add",
      "Send a model file to be stored and served; a model of that name is replaced",
      {{"landmarkdb model add box box.json", ""},
       {"landmarkdb model add crate crate.obj --units mm", "a polyhedron in millimetres"}});
  struct Arguments {
    std::string name, file, units;
  };
  const auto a = std::make_shared<Arguments>();
  command->add_option("NAME", a->name, "Name of the model")->required();
  command->add_option("FILE", a->file, "Model: .json, .cao (ViSP), or an .obj or .ply polyhedron")
      ->required();
  command->add_option("--units", a->units, "Unit of the file's lengths [its own, else m]")
      ->check(CLI::IsMember(kUnitNames));
  on_model_request(*command, program, [a](Session& session) {
    const FileBytes file = read_whole_file(a->file, kMaxModelBytes);
    const ModelAdd add{a->name,
                       std::string(reinterpret_cast<const char*>(file.data.get()), file.size),
                       std::filesystem::path(a->file).filename().string(),
                       a->units};
    return session.connect().add_model(add, session.context());
  });
}

void add_remove(CLI::App& parent, Program& program) {
  CLI::App* command =
      cli::add_command(parent, "remove", "Remove a model", {{"landmarkdb model remove box", ""}});
  const auto name = add_name(*command, "model");
  on_request(
      *command,
      program,
      [name](Session& session) {
        session.connect().remove_model(*name, session.context());
        return *name;
      },
      [&program](const std::string& removed) {
        program.print(Json{{"removed", removed}},
                      "removed model " + cli::printable(removed) + "\n");
      });
}

void add_rename(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent, "rename", "Rename a model", {{"landmarkdb model rename box parcel", ""}});
  const auto names = add_renaming(*command, "model");
  on_model_request(*command, program, [names](Session& session) {
    return session.connect().rename_model(names->from, names->to, session.context());
  });
}

}  // namespace

void add_model_commands(CLI::App& app, Program& program) {
  CLI::App* group = cli::add_command(app,
                                     "model",
                                     "List, show and change the models of the server",
                                     {{"landmarkdb model list", ""}});
  group->require_subcommand(1);
  add_list(*group, program);
  add_show(*group, program);
  add_add(*group, program);
  add_remove(*group, program);
  add_rename(*group, program);
}

}  // namespace landmarkdb::client
