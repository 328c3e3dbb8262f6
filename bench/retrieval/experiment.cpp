#include "bench/retrieval/experiment.hpp"

#include <algorithm>
#include <utility>

#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "datasets/subsample.hpp"
#include "engine/retrieval/describe_scene.hpp"

namespace landmarkdb::bench {

ExperimentOptions temple_experiment() {
  ExperimentOptions options;
  options.points = datasets::kPaperTemplePoints;
  options.query_points = datasets::kPaperTempleQueryPoints;
  return options;
}

ExperimentOptions lobby_experiment() {
  ExperimentOptions options;
  options.name = "lobby";
  options.type = datasets::PlaceType::kLobby;
  options.points = datasets::kPaperLobbyPoints;
  options.query_points = datasets::kPaperLobbyQueryPoints;
  return options;
}

Experiment make_experiment(const ExperimentOptions& options, const RunContext& context) {
  Experiment experiment;
  experiment.options = options;
  datasets::PlaceOptions place;
  place.type = options.type;
  place.seed = options.seed;
  experiment.place = datasets::make_place(place);
  datasets::ScannerOptions scanner;
  scanner.points = options.points;
  scanner.seed = options.seed;
  experiment.scan =
      datasets::merge_stations(datasets::scan_place(experiment.place, scanner, context));

  // Few frames have less than the 12,721 valid pixels asked for: twice as many poses are plenty.
  const auto wanted = static_cast<std::size_t>(std::max(options.frames, 0));
  const auto poses = datasets::sample_camera_poses(experiment.place, 2 * wanted, options.seed, {});
  for (std::size_t i = 0; i < poses.size() && experiment.frames.size() < wanted; ++i) {
    datasets::DepthCameraOptions camera;
    camera.seed = options.seed + i;
    Frame frame;
    frame.full = datasets::render_depth(experiment.place, poses[i], camera, context);
    if (frame.full.valid < std::max<std::size_t>(options.query_points, 1)) continue;
    frame.query = datasets::subsample(frame.full.cloud, options.query_points, options.seed + i);
    experiment.frames.push_back(std::move(frame));
  }
  return experiment;
}

std::shared_ptr<const Catalog> index_experiment(const Experiment& experiment,
                                                KeypointMethod keypoints,
                                                const RunContext& context) {
  IndexOptions options;
  options.keypoints = keypoints;
  options.up = experiment.place.up;
  std::vector<Scan> scans(1);
  scans[0].cloud = experiment.scan;
  CatalogEntry entry;
  entry.scene_id = 1;
  entry.version = 1;
  entry.landmarks = experiment.place.landmarks;
  entry.record = std::make_shared<SceneRecord>(
      describe_scene(experiment.options.name, std::move(scans), options, context));
  auto catalog = std::make_shared<Catalog>();
  catalog->entries.push_back(std::move(entry));
  return catalog;
}

}  // namespace landmarkdb::bench
