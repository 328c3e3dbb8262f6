// Depth frames of generated places, asked against a catalogue of them: right, wrong, declined, and
// the evidence of every best pose.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/retrieval/frame_tally.hpp"
#include "bench/retrieval/funnel.hpp"
#include "bench/retrieval/pose_errors.hpp"
#include "cli/write_file.hpp"
#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "engine/geometry/pose.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/localizer.hpp"
#include "tests/support/normalised_error.hpp"

namespace landmarkdb::bench {

namespace {

struct Settings {
  int catalogs = 1;          // one after another; their seeds are 100 apart
  int places = 6;            // in a catalogue
  int strangers = 2;         // not in it: whatever their frames get is wrong
  int frames = 10;           // a place
  int stranger_frames = -1;  // a stranger; -1: as many
  std::uint64_t seed = 1000;
  std::size_t points = 600'000;  // a place
  double size = 1.0;             // of a place; 1: as the type has it
  int only = -1;                 // ask the frames of this place alone
  bool twins = false;            // every second place is of the same plan as the one before
  int day = 0;                   // of the frames; the places are scanned on day 0
  bool gravity = false;
  bool both = false;             // without gravity, then with it
  bool funnel = false;           // say at which stage each frame was lost
  std::string sensor = "depth";  // or "lidar"
  int threads = 2;
  std::string json;
};

// Of the normals a laser sees that looks all around: 1/3 at most (DepthFrame::normal_spread).
constexpr double kAllAround = 1.0 / 3.0;

// What a sensor at a known pose saw.
struct TakenFrame {
  PointCloud cloud;
  Eigen::Isometry3d T_scene_sensor = Eigen::Isometry3d::Identity();
  Eigen::Vector3d up_sensor = Eigen::Vector3d::UnitZ();
  double normal_spread = 0.0;
};

datasets::Place place_of(const Settings& settings, int i, int day) {
  const auto types = datasets::all_place_types();
  const int plan = settings.twins ? i / 2 : i;
  datasets::PlaceOptions options;
  options.type = types[(static_cast<std::size_t>(plan) + settings.seed / 100) % types.size()];
  options.seed = settings.seed + static_cast<std::uint64_t>(plan);
  options.twin = settings.twins ? static_cast<std::uint64_t>(i % 2) : 0;
  options.day = static_cast<std::uint64_t>(day);
  options.floors = 1;
  options.size = settings.size;
  return datasets::make_place(options);
}

CatalogEntry index_place(const datasets::Place& place,
                         const Settings& settings,
                         int number,
                         const RunContext& context) {
  datasets::ScannerOptions scanner;
  scanner.points = settings.points;
  scanner.seed = settings.seed;
  std::vector<Scan> scans(1);
  scans[0].cloud = datasets::merge_stations(datasets::scan_place(place, scanner, context));
  IndexOptions options;
  options.up = place.up;
  const auto start = std::chrono::steady_clock::now();
  CatalogEntry entry;
  entry.scene_id = number + 1;
  entry.version = 1;
  entry.record = std::make_shared<SceneRecord>(
      describe_scene("place-" + std::to_string(number), std::move(scans), options, context));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::fprintf(stderr,
               "%s %s: voxel %.3f, %zu points, %zu keypoints, %.1f s\n",
               entry.record->name.c_str(),
               place.name.c_str(),
               entry.record->options.voxel_m,
               entry.record->prepared.size(),
               entry.record->descriptors.size(),
               took.count());
  return entry;
}

// The share of the frame's points that lie near the entry's surface at the true pose.
double scanned_share(const TakenFrame& frame, const Entry& entry) {
  constexpr std::size_t kEvery = 37;  // of 307,200 pixels, some 8,000; no divisor of the width
  const Eigen::Vector3d origin = entry.record().prepared.origin;
  std::size_t seen = 0;
  std::size_t near = 0;
  for (std::size_t i = 0; i < frame.cloud.size(); i += kEvery) {
    const Eigen::Vector3f& p = frame.cloud.points[i];
    if (!p.allFinite()) continue;
    ++seen;
    const Eigen::Vector3d there = frame.T_scene_sensor * p.cast<double>() - origin;
    near += entry.grid.near(there.cast<float>()) != nullptr ? 1U : 0U;
  }
  return seen == 0 ? 0.0 : static_cast<double>(near) / static_cast<double>(seen);
}

void print_row(const AskedFrame& asked, const QueryResult& answer, const Eigen::Isometry3d& truth) {
  const bool any = !answer.hypotheses.empty();
  const Fit fit = any ? answer.hypotheses[0].fit : Fit{};
  std::printf("%s,%d,%.4f,%d,%d,%.4f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.5f,",
              asked.stranger() ? "stranger" : asked.place.c_str(),
              asked.number,
              asked.normal_spread,
              static_cast<int>(asked.status),
              asked.first() ? 1 : 0,
              std::min(asked.metres, 99.0),
              asked.degrees,
              any ? answer.hypotheses[0].confidence : 0.0,
              fit.quality,
              fit.overlap,
              fit.explained,
              fit.coverage,
              fit.free_space_violation,
              fit.margin,
              fit.observability);
  std::printf("%u,%lu,%.4f,%.0f,%.4f,%.4f,%.3f,%.3f,%d,%d,%.0f,%.4f\n",
              any ? answer.hypotheses[0].counts.inliers : 0U,
              static_cast<unsigned long>(answer.query.keypoints),
              fit.rmse_m,
              fit.agreeing,
              fit.contrast,
              fit.contradicted,
              asked.first()
                  ? testing::normalised_squared_error(
                        answer.hypotheses[0].covariance, answer.hypotheses[0].T_scene_sensor, truth)
                  : 0.0,
              asked.scanned,
              asked.gravity ? 1 : 0,
              asked.catalog,
              asked.milliseconds,
              fit.refuted);
  std::fflush(stdout);
}

// Asks one frame; `asked` says what is known of it and is filled with the rest.
void ask(const TakenFrame& frame,
         const Localizer& localizer,
         const RunContext& context,
         AskedFrame& asked) {
  QueryOptions options;
  if (asked.gravity) options.up = frame.up_sensor;
  const QueryResult answer = localizer.query(frame.cloud, options, context);
  asked.status = answer.status;
  asked.milliseconds = answer.timings.total.count();
  if (!answer.hypotheses.empty() && answer.hypotheses[0].scene == asked.place) {
    Eigen::Isometry3d estimate;
    estimate.matrix() = answer.hypotheses[0].T_scene_sensor;
    const PoseError error = pose_error(frame.T_scene_sensor, estimate);
    asked.metres = error.metres;
    asked.degrees = error.degrees;
  }
  print_row(asked, answer, frame.T_scene_sensor);
}

void print_funnel(const Funnel& funnel) {
  std::printf(
      "#funnel keypoints %zu proposals %zu near %zu loose %zu ranked %d assessed %d nearest "
      "%.3f truth %.4f drift %.3f best %.4f\n",
      funnel.keypoints,
      funnel.proposals,
      funnel.near_proposals,
      funnel.loose_proposals,
      funnel.ranked,
      funnel.assessed,
      funnel.nearest_m,
      funnel.truth_score,
      funnel.truth_drift_m,
      funnel.best_score);
}

// A catalogue of the settings' places, and the strangers behind them.
struct Generated {
  std::vector<datasets::Place> places;
  std::shared_ptr<Catalog> catalog = std::make_shared<Catalog>();
  std::vector<Entry> entries;  // as the localizer makes them
};

Generated generate(const Settings& settings, const RunContext& context) {
  Generated made;
  for (int i = 0; i < settings.places + settings.strangers; ++i) {
    made.places.push_back(place_of(settings, i, settings.day));
    if (i >= settings.places) continue;
    const auto scanned = settings.day == 0 ? made.places.back() : place_of(settings, i, 0);
    made.catalog->entries.push_back(index_place(scanned, settings, i, context));
    made.entries.push_back(make_entry(made.catalog->entries.back()));
  }
  return made;
}

std::vector<Eigen::Isometry3d> sensor_poses(const datasets::Place& place,
                                            const Settings& settings,
                                            std::size_t count) {
  return settings.sensor == "lidar" ? datasets::sample_upright_poses(place, count, settings.seed)
                                    : datasets::sample_camera_poses(place, count, settings.seed);
}

TakenFrame take_frame(const datasets::Place& place,
                      const Eigen::Isometry3d& T_scene_sensor,
                      const Settings& settings,
                      std::uint64_t seed,
                      const RunContext& context) {
  TakenFrame taken;
  taken.T_scene_sensor = T_scene_sensor;
  taken.up_sensor = T_scene_sensor.linear().transpose() * place.up;
  if (settings.sensor == "lidar") {
    datasets::LidarOptions lidar;
    lidar.seed = seed;
    taken.cloud = datasets::render_lidar(place, T_scene_sensor, lidar, context);
    taken.normal_spread = kAllAround;
    return taken;
  }
  datasets::DepthCameraOptions camera;
  camera.seed = seed;
  datasets::DepthFrame frame = datasets::render_depth(place, T_scene_sensor, camera, context);
  taken.cloud = std::move(frame.cloud);
  taken.normal_spread = frame.normal_spread;
  return taken;
}

void ask_place(const Generated& made,
               std::size_t p,
               const Settings& settings,
               int number,
               const Localizer& localizer,
               const RunContext& context,
               std::vector<AskedFrame>& asked) {
  const bool known = p < made.entries.size();
  const std::vector<Level> levels =
      settings.funnel ? make_levels(made.entries) : std::vector<Level>{};
  const int count =
      known || settings.stranger_frames < 0 ? settings.frames : settings.stranger_frames;
  const std::vector<Eigen::Isometry3d> poses =
      sensor_poses(made.places[p], settings, static_cast<std::size_t>(count));
  for (int f = 0; f < count; ++f) {
    const TakenFrame frame = take_frame(made.places[p],
                                        poses[static_cast<std::size_t>(f)],
                                        settings,
                                        settings.seed + static_cast<std::uint64_t>(f),
                                        context);
    for (const bool gravity : {false, true}) {
      if (!settings.both && gravity != settings.gravity) continue;
      AskedFrame one;
      if (known) one.place = made.catalog->entries[p].record->name;
      one.catalog = number;
      one.number = f;
      one.gravity = gravity;
      one.normal_spread = frame.normal_spread;
      one.scanned = known ? scanned_share(frame, made.entries[p]) : 0.0;
      ask(frame, localizer, context, one);
      asked.push_back(one);
      if (!settings.funnel || !known) continue;
      QueryOptions options;
      if (gravity) options.up = frame.up_sensor;
      print_funnel(
          follow(frame.cloud, options, made.entries, levels, p, frame.T_scene_sensor, context));
    }
  }
}

std::string in_words(const Settings& s) {
  return std::to_string(s.catalogs) + " catalogues of " + std::to_string(s.places) +
         " generated places, " + std::to_string(s.points) + " points each, " +
         std::to_string(s.frames) + " frames a place, " + std::to_string(s.strangers) +
         " strangers, " + s.sensor + ", seed " + std::to_string(s.seed) + ", " +
         std::to_string(s.threads) + " threads";
}

int run(Settings settings) {
  RunContext context;
  context.threads = settings.threads;
  const std::string words = in_words(settings);
  std::puts(
      "place,frame,spread,status,right,metres,degrees,confidence,quality,overlap,explained,"
      "coverage,crossed,margin,observability,inliers,keypoints,rmse_m,agreeing,contrast,"
      "contradicted,nees,scanned,gravity,catalog,ms,refuted");
  std::vector<AskedFrame> asked;
  constexpr std::uint64_t kSeedStep = 100;
  for (int number = 0; number < settings.catalogs; ++number, settings.seed += kSeedStep) {
    const Generated made = generate(settings, context);
    const Localizer localizer(made.catalog, context);
    for (std::size_t p = 0; p < made.places.size(); ++p) {
      if (settings.only >= 0 && p != static_cast<std::size_t>(settings.only)) continue;
      ask_place(made, p, settings, number, localizer, context, asked);
    }
    std::fprintf(stderr, "%s", tally_table(tally_rows(asked)).c_str());
  }
  if (!settings.json.empty()) {
    cli::write_file(settings.json, tally_json(tally_rows(asked), words), "--json");
  }
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"Recall and pose error of depth frames in generated places"};
  app.add_option("--catalogs", settings.catalogs, "Catalogues, one after another, seeds 100 apart");
  app.add_option("--places", settings.places, "Places in a catalogue");
  app.add_option(
      "--strangers", settings.strangers, "Places whose frames are asked but that are not in it");
  app.add_option("--frames", settings.frames, "Frames a place");
  app.add_option(
      "--stranger-frames", settings.stranger_frames, "Frames a stranger, if not as many");
  app.add_option("--seed", settings.seed, "Of the places, frames and noise");
  app.add_option("--points", settings.points, "Scanned points a place");
  app.add_option("--size", settings.size, "Size of the places, 1: as their type has it");
  app.add_flag("--twins", settings.twins, "Every second place has the plan of the one before");
  app.add_option("--day", settings.day, "Day of the frames: from 1 on clutter stands elsewhere");
  app.add_option("--only", settings.only, "Ask the frames of this place alone");
  app.add_flag("--gravity", settings.gravity, "Tell the query which way is up");
  app.add_flag("--both", settings.both, "Ask every frame without gravity and with it");
  app.add_option("--json", settings.json, "Write the summary as JSON too");
  app.add_flag("--funnel", settings.funnel, "Say at which stage each frame was lost");
  app.add_option("--sensor", settings.sensor, "depth: a Kinect's frame; lidar: a turn of 16 lines")
      ->check(CLI::IsMember({"depth", "lidar"}));
  app.add_option("--threads", settings.threads, "Threads");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
