// Asks every monocular case of a folder of real data, from its picture alone, and prints right,
// wrong or declined with the errors and the time.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/main_guard.hpp"
#include "engine/base/error.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/mono/model_triples.hpp"
#include "engine/mono/read_image.hpp"
#include "engine/mono/read_model.hpp"
#include "engine/mono/recognizer.hpp"

namespace landmarkdb::bench {
namespace {

constexpr double kRightMetres = 0.10;
constexpr double kRightDegrees = 5.0;

struct MonoCase {
  std::string id;
  std::string target;  // a model's name; empty: nothing known is in the picture
  std::filesystem::path image, camera;
  std::optional<Eigen::Isometry3d> T_camera_object;
};

nlohmann::json read_json(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw Error(ErrorCode::kInvalidArgument, "cannot read " + path.string());
  return nlohmann::json::parse(file);
}

std::vector<MonoCase> read_cases(const std::filesystem::path& folder,
                                 const std::vector<std::string>& names) {
  std::vector<MonoCase> cases;
  for (const auto& row : read_json(folder / "cases.json")) {
    if (row.at("kind") != "monocular") continue;
    MonoCase one;
    one.id = row.at("id");
    one.image = folder / row.at("query").get<std::string>();
    one.camera = folder / row.at("camera").get<std::string>();
    if (!row.at("target").empty()) {
      const std::string file = row.at("target").at(0);
      for (const std::string& name : names) {
        if (std::filesystem::path(file).filename().string().starts_with(name)) one.target = name;
      }
      const auto numbers = row.at("T_target_query").get<std::array<double, 16>>();
      one.T_camera_object = from_row_major(numbers).inverse();
    }
    cases.push_back(one);
  }
  return cases;
}

std::shared_ptr<const MonoCatalog> read_catalog(const std::filesystem::path& folder) {
  auto catalog = std::make_shared<MonoCatalog>();
  const nlohmann::json database = read_json(folder / "database.json");
  for (const auto& name : database.at("monocular")) {
    auto record = std::make_shared<MonoModelRecord>();
    record->model = read_model(folder / name.get<std::string>(), {}).model;
    record->triples = make_triples(record->model);
    MonoCatalogEntry entry;
    entry.model_id = static_cast<std::int64_t>(catalog->entries.size()) + 1;
    entry.record = record;
    catalog->entries.push_back(entry);
  }
  return catalog;
}

struct PoseError {
  double metres = std::numeric_limits<double>::infinity();
  double degrees = std::numeric_limits<double>::infinity();
};

// Of the best symmetry; metres at the middle of the model.
PoseError pose_error(const MonoModel& model,
                     const Eigen::Isometry3d& found,
                     const Eigen::Isometry3d& truth) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const ModelFeature& point : model.points) {
    middle += point.xyz / static_cast<double>(model.points.size());
  }
  PoseError best;
  std::vector<Eigen::Matrix4d> symmetries = model.symmetries;
  if (symmetries.empty()) symmetries.push_back(Eigen::Matrix4d::Identity());
  for (const Eigen::Matrix4d& S : symmetries) {
    const Eigen::Isometry3d same = truth * Eigen::Isometry3d(S).inverse();
    const double degrees =
        rotation_angle_rad(same.linear().transpose() * found.linear()) * 180.0 / std::numbers::pi;
    if (degrees < best.degrees) best = {(same * middle - found * middle).norm(), degrees};
  }
  return best;
}

struct Tally {
  int right = 0, wrong = 0, declined = 0;
};

void ask(const MonoCase& one,
         const MonoCatalog& catalog,
         const Recognizer& recognizer,
         Tally& tally) {
  const GreyImage image = read_image(one.image);
  const Camera camera = read_camera(one.camera);
  const RecognizeResult answer = recognizer.recognize(image, camera, {}, {});
  const auto ms = [](StageTimings::Duration d) {
    return std::chrono::duration<double, std::milli>(d).count();
  };
  const bool found = answer.status == RecognizeStatus::kRecognized;
  std::string verdict = found ? "wrong" : "declined";
  PoseError error;
  if (found && answer.hypotheses[0].model == one.target) {
    for (const MonoCatalogEntry& entry : catalog.entries) {
      if (entry.record->model.name != one.target) continue;
      error = pose_error(
          entry.record->model, answer.hypotheses[0].T_camera_object, *one.T_camera_object);
    }
    if (error.metres <= kRightMetres && error.degrees <= kRightDegrees) verdict = "right";
  }
  if (!found && one.target.empty()) verdict = "right";
  tally.right += verdict == "right" ? 1 : 0;
  tally.wrong += verdict == "wrong" ? 1 : 0;
  tally.declined += verdict == "declined" ? 1 : 0;
  std::printf("%-18s %-8s", one.id.c_str(), verdict.c_str());
  if (!answer.hypotheses.empty()) {
    const MonoHypothesis& h = answer.hypotheses[0];
    std::printf(
        " %-13s %8.2f mm %6.2f deg  confidence %.3f  log10 NFA %6.1f  %zu of %zu points  "
        "edges %.2f  rms %.2f px",
        h.model.c_str(),
        error.metres * 1000.0,
        error.degrees,
        h.confidence,
        h.log10_nfa,
        h.pairs.size(),
        h.visible_points,
        h.edge_share,
        h.rms_px);
  } else {
    std::printf(" %s", answer.reason.c_str());
  }
  std::printf("  %zu features  %.1f ms (features %.1f)\n",
              answer.image_points,
              ms(answer.timings.total),
              ms(answer.timings.features));
}

int run(const std::filesystem::path& folder) {
  const std::shared_ptr<const MonoCatalog> catalog = read_catalog(folder);
  const Recognizer recognizer(catalog);
  std::vector<std::string> names;
  for (const MonoCatalogEntry& entry : catalog->entries) names.push_back(entry.record->model.name);
  Tally tally;
  for (const MonoCase& one : read_cases(folder, names)) ask(one, *catalog, recognizer, tally);
  std::printf("%d right, %d wrong, %d declined\n", tally.right, tally.wrong, tally.declined);
  return 0;
}

}  // namespace
}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  std::string folder;
  CLI::App app{
      "Asks every monocular case of FOLDER (cases.json, database.json) and prints right, wrong or "
      "declined, the errors modulo the model's symmetries, and the time."};
  app.name("landmarkdb-bench-mono-real");
  app.add_option("FOLDER", folder, "A folder of real data")->required();
  return landmarkdb::cli::run_main(argc, argv, app, [&] { return landmarkdb::bench::run(folder); });
}
