// Depth frames of generated places, asked against a catalogue of them: right, wrong, declined, and
// the evidence of every best pose.

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/retrieval/funnel.hpp"
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
  int places = 6;     // in the catalogue
  int strangers = 2;  // not in it: whatever their frames get is wrong
  int frames = 10;    // a place
  std::uint64_t seed = 1000;
  std::size_t points = 600'000;  // a place
  int only = -1;                 // ask the frames of this place alone
  bool gravity = false;
  bool funnel = false;  // say at which stage each frame was lost
  int threads = 2;
};

datasets::Place place_of(const Settings& settings, int i) {
  const auto types = datasets::all_place_types();
  datasets::PlaceOptions options;
  options.type = types[(static_cast<std::size_t>(i) + settings.seed / 100) % types.size()];
  options.seed = settings.seed + static_cast<std::uint64_t>(i);
  options.floors = 1;
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

struct Tally {
  int asked = 0, right = 0, wrong = 0, ambiguous = 0, first = 0;
  std::vector<double> metres, degrees, milliseconds;
};

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Asks one frame; `name` is the place it was taken in, or empty for a stranger's.
void ask(const datasets::DepthFrame& frame,
         const std::string& name,
         int number,
         const Localizer& localizer,
         const Settings& settings,
         const RunContext& context,
         Tally& all,
         Tally& informative) {
  QueryOptions options;
  if (settings.gravity) options.up = frame.up_camera;
  const QueryResult answer = localizer.query(frame.cloud, options, context);
  double metres = 1e9;
  double degrees = 180.0;
  const Fit fit = answer.hypotheses.empty() ? Fit{} : answer.hypotheses[0].fit;
  if (!answer.hypotheses.empty() && answer.hypotheses[0].scene == name) {
    const Eigen::Matrix4d& T = answer.hypotheses[0].T_scene_sensor;
    metres = (T.topRightCorner<3, 1>() - frame.T_scene_camera.translation()).norm();
    degrees =
        rotation_angle_rad(frame.T_scene_camera.linear().transpose() * T.topLeftCorner<3, 3>()) *
        57.29577951308232;
  }
  const bool right = metres < 0.10 && degrees < 5.0;
  constexpr double kInformative = 0.03;
  for (Tally* tally : {&all, &informative}) {
    if (tally == &informative && (frame.normal_spread < kInformative || name.empty())) continue;
    if (tally == &all && name.empty()) continue;
    ++tally->asked;
    tally->first += right ? 1 : 0;
    tally->ambiguous += answer.status == QueryStatus::kAmbiguous ? 1 : 0;
    if (answer.status == QueryStatus::kLocalized) ++(right ? tally->right : tally->wrong);
    if (right && answer.status == QueryStatus::kLocalized) {
      tally->metres.push_back(metres);
      tally->degrees.push_back(degrees);
    }
    tally->milliseconds.push_back(answer.timings.total.count());
  }
  std::printf(
      "%s,%d,%.4f,%d,%d,%.4f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.5f,%u,%lu,%.4f,%.0f,%.4f,%."
      "4f,%.3f,"
      "%.0f\n",
      name.empty() ? "stranger" : name.c_str(),
      number,
      frame.normal_spread,
      static_cast<int>(answer.status),
      right ? 1 : 0,
      std::min(metres, 99.0),
      degrees,
      answer.hypotheses.empty() ? 0.0 : answer.hypotheses[0].confidence,
      fit.quality,
      fit.overlap,
      fit.explained,
      fit.coverage,
      fit.free_space_violation,
      fit.margin,
      fit.observability,
      answer.hypotheses.empty() ? 0U : answer.hypotheses[0].counts.inliers,
      static_cast<unsigned long>(answer.query.keypoints),
      fit.rmse_m,
      fit.agreeing,
      fit.contrast,
      fit.contradicted,
      right ? testing::normalised_squared_error(answer.hypotheses[0].covariance,
                                                answer.hypotheses[0].T_scene_sensor,
                                                frame.T_scene_camera)
            : 0.0,
      answer.timings.total.count());
  std::fflush(stdout);
}

void print(const char* what, const Tally& tally) {
  std::fprintf(stderr,
               "%-12s asked %d, first %d (%.0f %%), localized right %d (%.0f %%), wrong %d, "
               "ambiguous %d; median "
               "%.4f m %.3f deg, %.0f ms\n",
               what,
               tally.asked,
               tally.first,
               100.0 * tally.first / std::max(tally.asked, 1),
               tally.right,
               100.0 * tally.right / std::max(tally.asked, 1),
               tally.wrong,
               tally.ambiguous,
               median(tally.metres),
               median(tally.degrees),
               median(tally.milliseconds));
}

int run(const Settings& settings) {
  RunContext context;
  context.threads = settings.threads;
  auto catalog = std::make_shared<Catalog>();
  std::vector<datasets::Place> places;
  for (int i = 0; i < settings.places + settings.strangers; ++i) {
    places.push_back(place_of(settings, i));
    if (i < settings.places)
      catalog->entries.push_back(index_place(places.back(), settings, i, context));
  }
  const Localizer localizer(catalog, context);
  std::vector<Entry> entries;
  if (settings.funnel) {
    for (const CatalogEntry& stored : catalog->entries) entries.push_back(make_entry(stored));
  }
  const std::vector<Level> levels = make_levels(entries);
  std::puts(
      "place,frame,spread,status,right,metres,degrees,confidence,quality,overlap,explained,"
      "coverage,"
      "crossed,margin,observability,inliers,keypoints,rmse_m,agreeing,contrast,contradicted,nees,"
      "ms");
  Tally all;
  Tally informative;
  for (std::size_t p = 0; p < places.size(); ++p) {
    if (settings.only >= 0 && p != static_cast<std::size_t>(settings.only)) continue;
    const bool known = p < static_cast<std::size_t>(settings.places);
    const auto poses = datasets::sample_camera_poses(
        places[p], static_cast<std::size_t>(settings.frames), settings.seed);
    for (int f = 0; f < settings.frames; ++f) {
      datasets::DepthCameraOptions camera;
      camera.seed = settings.seed + static_cast<std::uint64_t>(f);
      const auto frame =
          datasets::render_depth(places[p], poses[static_cast<std::size_t>(f)], camera, context);
      ask(frame,
          known ? "place-" + std::to_string(p) : "",
          f,
          localizer,
          settings,
          context,
          all,
          informative);
      if (!settings.funnel || !known) continue;
      QueryOptions options;
      if (settings.gravity) options.up = frame.up_camera;
      const Funnel funnel =
          follow(frame.cloud, options, entries, levels, p, frame.T_scene_camera, context);
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
  }
  print("all", all);
  print("informative", informative);
  return 0;
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"Recall and pose error of depth frames in generated places"};
  app.add_option("--places", settings.places, "Places in the catalogue");
  app.add_option(
      "--strangers", settings.strangers, "Places whose frames are asked but that are not in it");
  app.add_option("--frames", settings.frames, "Frames a place");
  app.add_option("--seed", settings.seed, "Of the places, frames and noise");
  app.add_option("--points", settings.points, "Scanned points a place");
  app.add_option("--only", settings.only, "Ask the frames of this place alone");
  app.add_flag("--gravity", settings.gravity, "Tell the query which way is up");
  app.add_flag("--funnel", settings.funnel, "Say at which stage each frame was lost");
  app.add_option("--threads", settings.threads, "Threads");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
