#include <filesystem>
#include <memory>
#include <utility>

#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "client/choices.hpp"
#include "client/program.hpp"
#include "client/render_recognition.hpp"
#include "client/session.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb::client {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMaxModelBytes = std::uint64_t{64} << 20U;

// A command whose whole work is one request that answers with the model as it is now.
template <typename Request>
void model_action(CLI::App& command, Program& program, Request request) {
  command.callback([request = std::move(request), &program] {
    program.action = [request, &program] {
      Session session(program.options);
      const ModelInfo model = request(session);
      session.finish();
      Json json = model_json(model);
      if (model.replaced) json["replaced"] = true;
      program.print(json, model_text(model));
      return 0;
    };
  });
}

void add_list(CLI::App& parent, Program& program) {
  CLI::App* command =
      cli::add_command(parent, "list", "List the models", {{"landmarkdb model list", ""}});
  command->callback([&program] {
    program.action = [&program] {
      Session session(program.options);
      const std::vector<ModelInfo> models = session.connect().models(session.context());
      session.finish();
      program.print(models_json(models), models_text(models));
      return 0;
    };
  });
}

void add_show(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent,
      "show",
      "Show one model; with --json its points, edges, faces, circles and symmetries too",
      {{"landmarkdb model show box --json", ""}});
  const auto name = std::make_shared<std::string>();
  command->add_option("NAME", *name, "Name of the model")->required();
  model_action(*command, program, [name](Session& session) {
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
  model_action(*command, program, [a](Session& session) {
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
  const auto name = std::make_shared<std::string>();
  command->add_option("NAME", *name, "Name of the model")->required();
  command->callback([name, &program] {
    program.action = [name, &program] {
      Session session(program.options);
      session.connect().remove_model(*name, session.context());
      session.finish();
      program.print(Json{{"removed", *name}}, "removed model " + *name + "\n");
      return 0;
    };
  });
}

void add_rename(CLI::App& parent, Program& program) {
  CLI::App* command = cli::add_command(
      parent, "rename", "Rename a model", {{"landmarkdb model rename box parcel", ""}});
  const auto names = std::make_shared<std::pair<std::string, std::string>>();
  command->add_option("OLD", names->first, "Name of the model")->required();
  command->add_option("NEW", names->second, "Its new name")->required();
  model_action(*command, program, [names](Session& session) {
    return session.connect().rename_model(names->first, names->second, session.context());
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
