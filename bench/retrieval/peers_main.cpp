// Depth frames of one generated place: ours and what Debian's libraries make of the same ones.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/retrieval/experiment.hpp"
#include "bench/retrieval/peer.hpp"
#include "bench/retrieval/pose_errors.hpp"
#include "engine/retrieval/localizer.hpp"

namespace landmarkdb::bench {

namespace {

struct Settings {
  std::string type = "lobby";
  std::size_t points = 600'000;
  std::size_t query_points = 0;  // of a frame; 0: all
  int frames = 10;
  std::uint64_t seed = 10'000;
  bool gravity = false;
  int threads = 2;
  std::string json;
};

struct Row {
  std::string method;
  double prepare_s = 0.0;
  std::vector<double> query_s;
  std::vector<double> right_m, right_deg;  // errors of the right answers
  int right = 0, wrong = 0, declined = 0;
};

double seconds_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  return took.count();
}

void count(const std::optional<Eigen::Isometry3d>& answer,
           const Eigen::Isometry3d& truth,
           Row& row) {
  if (!answer) {
    ++row.declined;
    return;
  }
  const PoseError error = pose_error(truth, *answer);
  ++(error.right() ? row.right : row.wrong);
  if (!error.right()) return;
  row.right_m.push_back(error.metres);
  row.right_deg.push_back(error.degrees);
}

Row run_ours(const Experiment& experiment,
             const std::string& method,
             const QueryOptions& options,
             bool gravity,
             const RunContext& context) {
  Row row;
  row.method = method;
  std::unique_ptr<Localizer> localizer;
  row.prepare_s = seconds_of([&] {
    localizer = std::make_unique<Localizer>(
        index_experiment(experiment, KeypointMethod::kStructure, context), context);
  });
  for (const Frame& frame : experiment.frames) {
    QueryOptions query = options;
    if (gravity) query.up = frame.full.up_camera;
    std::optional<Eigen::Isometry3d> answer;
    row.query_s.push_back(seconds_of([&] {
      const QueryResult result = localizer->query(frame.query, query, context);
      if (result.status == QueryStatus::kLocalized) {
        answer = Eigen::Isometry3d(result.hypotheses[0].T_scene_sensor);
      }
    }));
    count(answer, frame.full.T_scene_camera, row);
  }
  return row;
}

Row run_peer(const Experiment& experiment, Peer& peer) {
  Row row;
  row.method = peer.name();
  row.prepare_s = seconds_of([&] { peer.prepare(experiment.scan); });
  for (const Frame& frame : experiment.frames) {
    std::optional<Eigen::Isometry3d> answer;
    row.query_s.push_back(seconds_of([&] { answer = peer.find(frame.query); }));
    count(answer, frame.full.T_scene_camera, row);
    std::fprintf(stderr, "%s: %.1f s\n", row.method.c_str(), row.query_s.back());
  }
  return row;
}

void print(const Row& row, const Row& ours) {
  std::printf("%-32s %5d %5d %8d %9.1f %9.3f %9.1f %9.1f %9.1f %9.2f\n",
              row.method.c_str(),
              row.right,
              row.wrong,
              row.declined,
              row.prepare_s,
              median(row.query_s),
              row.prepare_s / ours.prepare_s,
              median(row.query_s) / median(ours.query_s),
              1000.0 * median(row.right_m),
              median(row.right_deg));
}

nlohmann::json json_of(const Settings& settings, const std::vector<Row>& rows) {
  nlohmann::json out = {{"place", settings.type},
                        {"points", settings.points},
                        {"query_points", settings.query_points},
                        {"seed", settings.seed},
                        {"gravity", settings.gravity},
                        {"threads", settings.threads}};
  for (const Row& row : rows) {
    out["methods"].push_back({{"method", row.method},
                              {"right", row.right},
                              {"wrong", row.wrong},
                              {"declined", row.declined},
                              {"prepare_s", row.prepare_s},
                              {"query_s", row.query_s},
                              {"median_query_s", median(row.query_s)},
                              {"median_error_m", median(row.right_m)},
                              {"median_error_deg", median(row.right_deg)}});
  }
  return out;
}

int run(const Settings& settings) {
  RunContext context;
  context.threads = settings.threads;
  ExperimentOptions options;
  options.name = settings.type;
  options.type = datasets::place_type_from_name(settings.type);
  options.points = settings.points;
  options.query_points = settings.query_points;
  options.frames = settings.frames;
  options.seed = settings.seed;
  const Experiment experiment = make_experiment(options, context);

  std::vector<Row> rows;
  QueryOptions paper;
  paper.profile = Profile::kPaper;
  paper.ratio = 0.95;  // 0.7 leaves too few pairs, see landmarkdb-bench-paper
  rows.push_back(run_ours(experiment, "ours: robust", {}, settings.gravity, context));
  rows.push_back(run_ours(experiment, "ours: paper, ratio 0.95", paper, settings.gravity, context));
  auto peers = pcl_peers(settings.threads);
  if (peers.empty()) std::puts("PCL is left out: built without its registration library");
  auto more = open3d_peers();
  if (more.empty()) std::puts("Open3D is left out: built without libopen3d-dev");
  std::move(more.begin(), more.end(), std::back_inserter(peers));
  for (const auto& peer : peers) rows.push_back(run_peer(experiment, *peer));

  std::printf("%s, %zu points, %zu frames, seed %llu; times against ours: robust\n",
              settings.type.c_str(),
              experiment.scan.size(),
              experiment.frames.size(),
              static_cast<unsigned long long>(settings.seed));
  std::printf("%-32s %5s %5s %8s %9s %9s %9s %9s %9s %9s\n",
              "method",
              "right",
              "wrong",
              "declined",
              "prepare s",
              "query s",
              "prepare x",
              "query x",
              "error mm",
              "error deg");
  for (const Row& row : rows) print(row, rows[0]);
  if (!settings.json.empty()) {
    std::ofstream file(settings.json);
    file << json_of(settings, rows).dump(2) << "\n";
    if (!file.flush()) throw std::runtime_error("cannot write " + settings.json);
  }
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"Ours, PCL's and Open3D's pipelines on the same frames of a generated place"};
  app.add_option("--place", settings.type, "Type of place: lobby, temple, office, ...");
  app.add_option("--points", settings.points, "Scanned points of the place");
  app.add_option("--query-points", settings.query_points, "Points of a frame; 0: all");
  app.add_option("--frames", settings.frames, "Frames")->check(CLI::Range(1, 10'000));
  app.add_option("--seed", settings.seed, "Of place, scan, poses and noise");
  app.add_flag(
      "--gravity", settings.gravity, "Tell ours which way is up; the peers cannot be told");
  app.add_option("--threads", settings.threads, "Threads, where a method can be told");
  app.add_option("--json", settings.json, "Write the table as JSON too");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
