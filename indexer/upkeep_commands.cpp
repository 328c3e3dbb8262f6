#include <memory>
#include <string>
#include <vector>

#include <CLI/Option.hpp>
#include <nlohmann/json.hpp>

#include "cli/help.hpp"
#include "cli/table.hpp"
#include "engine/base/error.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/search_tables.hpp"
#include "engine/retrieval/scene_index.hpp"
#include "indexer/commands.hpp"
#include "indexer/long_job.hpp"
#include "indexer/scene_view.hpp"
#include "store/store.hpp"

namespace landmarkdb::indexer {
namespace {

const std::string kProgram = "landmarkdb-indexer --db site.db ";

std::string lines(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) text += cli::printable(sentence) + '\n';
  return text;
}

SceneDeriver scene_deriver() { return {make_scene_index, scene_index_format()}; }

ModelDeriver model_deriver() { return {make_triples, make_model_index, model_index_format()}; }

int damaged_unless(bool ok) { return ok ? 0 : exit_status(ErrorCode::kDataLoss); }

int run_check(const Program& program) {
  LongJob job(program);
  const CheckReport report = Store::open_read_only(program.database()).check(job.context());
  job.finish_progress();
  const std::string read =
      "read " + cli::counted(report.scenes, "scene") + ", " +
      cli::counted(report.versions, "version") + ", " + cli::counted(report.arrays, "array") +
      ", " + cli::counted(report.models, "model") + ", " + cli::bytes_text(report.bytes) + ": ";
  const std::string verdict =
      report.ok() ? "all sound\n" : cli::counted(report.findings.size(), "finding") + "\n";
  program.print({{"ok", report.ok()},
                 {"findings", report.findings},
                 {"scenes", report.scenes},
                 {"versions", report.versions},
                 {"arrays", report.arrays},
                 {"models", report.models},
                 {"bytes", report.bytes}},
                lines(report.findings) + read + verdict);
  return damaged_unless(report.ok());
}

int run_repair(const Program& program) {
  LongJob job(program);
  const RepairReport report = Store::open_read_write(program.database())
                                  .repair(job.context(), model_deriver(), scene_deriver());
  job.finish_progress();
  std::string text = lines(report.repaired);
  for (const std::string& left : report.remaining) text += "not repaired: " + left + '\n';
  if (text.empty()) text = "nothing to repair\n";
  program.print(
      {{"ok", report.ok()}, {"repaired", report.repaired}, {"remaining", report.remaining}}, text);
  return damaged_unless(report.ok());
}

int run_migrate(bool dry_run, const Program& program) {
  LongJob job(program);
  const MigrationReport report = Store::migrate(program.database(), dry_run, job.context());
  job.finish_progress();
  const std::string versions = "version " + std::to_string(report.from_version) + " to version " +
                               std::to_string(report.to_version);
  std::string text = lines(report.steps);
  if (report.from_version == report.to_version) {
    text += "already at version " + std::to_string(report.to_version) + ", nothing to do\n";
  } else {
    text += (dry_run ? "would migrate from " : "migrated from ") + versions + "\n";
  }
  if (!report.backup_path.empty()) text += "the file as it was: " + report.backup_path + "\n";
  program.print({{"dry_run", dry_run},
                 {"from_version", report.from_version},
                 {"to_version", report.to_version},
                 {"steps", report.steps},
                 {"backup", report.backup_path}},
                text);
  return 0;
}

int run_optimize(const Program& program) {
  LongJob job(program);
  const OptimizeReport report = Store::open_read_write(program.database())
                                    .optimize(job.context(), model_deriver(), scene_deriver());
  job.finish_progress();
  program.print({{"dropped", report.dropped},
                 {"renewed", report.renewed},
                 {"bytes_before", report.bytes_before},
                 {"bytes_after", report.bytes_after}},
                lines(report.dropped) + lines(report.renewed) +
                    cli::bytes_text(report.bytes_before) + " before, " +
                    cli::bytes_text(report.bytes_after) + " after\n");
  return 0;
}

void add_plain(CLI::App& app,
               Program& program,
               const std::string& name,
               const std::string& description,
               int (*run)(const Program&)) {
  cli::add_command(app, name, description, {{kProgram + name, ""}})->callback([run, &program] {
    program.action = [run, &program] { return run(program); };
  });
}

}  // namespace

void add_upkeep_commands(CLI::App& app, Program& program) {
  add_plain(app,
            program,
            "check",
            "Read every page, digest, reference and array; say what is damaged (status 5)",
            run_check);
  add_plain(app,
            program,
            "repair",
            "Rebuild what is derived and set aside what is damaged, so that the rest is served",
            run_repair);
  const auto dry_run = std::make_shared<bool>(false);
  CLI::App* migrate = cli::add_command(
      app,
      "migrate",
      "Bring a file of an older version to this program's, after a backup copy",
      {{kProgram + "migrate --dry-run", "what would be done"}, {kProgram + "migrate", ""}});
  migrate->add_flag("--dry-run", *dry_run, "Only say what would be done");
  migrate->callback([dry_run, &program] {
    program.action = [dry_run, &program] { return run_migrate(*dry_run, program); };
  });
  add_plain(app,
            program,
            "optimize",
            "Drop versions that rollback cannot reach, rebuild the index, give back unused space",
            run_optimize);
}

}  // namespace landmarkdb::indexer
