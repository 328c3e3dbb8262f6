// Both experiments of Cocias et al. 2014 at their sizes, on generated places with known truth: our
// table beside the paper's Table 2, and a marker in the same frames.

#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/retrieval/experiment.hpp"
#include "bench/retrieval/marker.hpp"
#include "bench/retrieval/paper_table.hpp"
#include "engine/retrieval/localizer.hpp"

namespace landmarkdb::bench {

namespace {

struct Settings {
  std::vector<std::string> places = {"temple", "lobby"};
  int frames = 10;
  std::uint64_t seed = 10'000;
  std::vector<std::string> keypoints = {"narf", "structure"};
  std::vector<double> ratios = {0.7, 0.95};
  std::vector<double> markers_m = {0.16, 0.5};
  bool full = false;  // ask with all points of each frame
  int threads = 2;
  std::string json;
};

void take(const QueryResult& answer, const Eigen::Isometry3d& truth, ErrorTally& tally) {
  ++tally.asked;
  tally.milliseconds.push_back(answer.timings.total.count());
  if (answer.status == QueryStatus::kAmbiguous) ++tally.ambiguous;
  if (answer.status != QueryStatus::kLocalized) return;
  const Eigen::Isometry3d T(answer.hypotheses[0].T_scene_sensor);
  const PoseError error = pose_error(truth, T);
  (error.right() ? tally.right : tally.wrong_ones).push_back(error);
}

MeasuredRow ask_all(const Experiment& experiment,
                    const Localizer& localizer,
                    std::string method,
                    const QueryOptions& options,
                    const RunContext& context) {
  MeasuredRow row{.place = experiment.options.name, .method = std::move(method), .tally = {}};
  for (const Frame& frame : experiment.frames) {
    take(localizer.query(frame.query, options, context), frame.full.T_scene_camera, row.tally);
  }
  return row;
}

// A marker whose place in the scene is known, in each frame: what it says of the camera in the
// scene (what ours are judged by), and of itself in the camera's frame. The first is off by the
// marker's own tilt times its distance: a degree at 3 m is 5 cm.
void ask_marker(const Experiment& experiment,
                double marker_m,
                const Settings& settings,
                std::vector<MeasuredRow>& rows) {
  char size[40];
  std::snprintf(size, sizeof size, ", %.2f m", marker_m);
  const std::string name = "marker: " + marker_name() + size;
  MeasuredRow row{.place = experiment.options.name, .method = name, .tally = {}};
  MeasuredRow own{.place = experiment.options.name, .method = name + ", in camera", .tally = {}};
  const datasets::DepthCameraOptions camera;
  const auto take_error = [](const PoseError& error, ErrorTally& tally) {
    (error.right() ? tally.right : tally.wrong_ones).push_back(error);
  };
  for (std::size_t i = 0; i < experiment.frames.size(); ++i) {
    const Eigen::Isometry3d& truth = experiment.frames[i].full.T_scene_camera;
    const std::uint64_t seed = settings.seed + i;
    ++row.tally.asked;
    ++own.tally.asked;
    const auto T_camera_marker =
        place_marker(experiment.place, truth, camera.camera, marker_m, seed);
    if (!T_camera_marker) continue;
    const GreyImage image = render_grey(experiment.place,
                                        truth,
                                        camera.camera,
                                        *marker_pattern(),
                                        marker_m,
                                        *T_camera_marker,
                                        seed);
    const auto start = std::chrono::steady_clock::now();
    const auto found = find_marker(image, camera.camera, marker_m);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    row.tally.milliseconds.push_back(took.count());
    own.tally.milliseconds.push_back(took.count());
    if (!found) continue;
    take_error(pose_error(truth, truth * *T_camera_marker * found->inverse()), row.tally);
    // Along and about the camera's axes: the offset of the centre, and the turn seen from there.
    Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
    off.linear() = found->linear() * T_camera_marker->linear().transpose();
    off.translation() = found->translation() - T_camera_marker->translation();
    take_error(pose_error(Eigen::Isometry3d::Identity(), off), own.tally);
  }
  rows.push_back(std::move(row));
  rows.push_back(std::move(own));
}

KeypointMethod method_of(const std::string& name) {
  if (name == "narf") return KeypointMethod::kNarf;
  if (name == "iss") return KeypointMethod::kIss;
  return name == "uniform" ? KeypointMethod::kUniform : KeypointMethod::kStructure;
}

void run_place(const std::string& name,
               const Settings& settings,
               const RunContext& context,
               std::vector<MeasuredRow>& rows) {
  ExperimentOptions options = name == "temple" ? temple_experiment() : lobby_experiment();
  options.frames = settings.frames;
  options.seed = settings.seed;
  if (settings.full) options.query_points = 0;
  const Experiment experiment = make_experiment(options, context);
  std::fprintf(stderr,
               "%s: %zu points, %zu frames of %zu points\n",
               name.c_str(),
               experiment.scan.size(),
               experiment.frames.size(),
               options.query_points);
  const Localizer robust(index_experiment(experiment, KeypointMethod::kStructure, context),
                         context);
  rows.push_back(ask_all(experiment, robust, "ours: robust", {}, context));
  for (const std::string& keypoints : settings.keypoints) {
    const Localizer localizer(index_experiment(experiment, method_of(keypoints), context), context);
    for (const double ratio : settings.ratios) {
      QueryOptions query;
      query.profile = Profile::kPaper;
      query.ratio = ratio;
      char method[80];
      std::snprintf(method, sizeof method, "ours: paper, %s, ratio %.2f", keypoints.c_str(), ratio);
      rows.push_back(ask_all(experiment, localizer, method, query, context));
    }
  }
  if (!marker_pattern()) return;
  for (const double marker_m : settings.markers_m) ask_marker(experiment, marker_m, settings, rows);
}

int run(const Settings& settings) {
  RunContext context;
  context.threads = settings.threads;
  std::vector<MeasuredRow> rows;
  for (const std::string& place : settings.places) run_place(place, settings, context, rows);
  std::printf("%s", table_text(rows).c_str());
  if (!marker_pattern()) std::puts("no marker rows: built without libapriltag-dev");
  if (!settings.json.empty()) {
    std::ofstream file(settings.json);
    file << table_json(rows, settings.seed);
    if (!file.flush()) throw std::runtime_error("cannot write " + settings.json);
  }
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"The paper's two experiments on generated places, beside its Table 2"};
  app.add_option("--place", settings.places, "temple, lobby")
      ->check(CLI::IsMember({"temple", "lobby"}));
  app.add_option("--frames", settings.frames, "Frames a place")->check(CLI::Range(1, 10'000));
  app.add_option("--seed", settings.seed, "Of places, scans, poses and noise");
  app.add_option("--keypoints", settings.keypoints, "Of the paper's profile: narf, structure, ...")
      ->check(CLI::IsMember({"narf", "structure", "uniform", "iss"}));
  app.add_option("--ratio", settings.ratios, "Of its ratio filter");
  app.add_option("--marker", settings.markers_m, "Sizes of the marker, metres");
  app.add_flag("--full", settings.full, "Ask with whole frames, not thinned to the paper's sizes");
  app.add_option("--threads", settings.threads, "Threads");
  app.add_option("--json", settings.json, "Write the tables as JSON too");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
