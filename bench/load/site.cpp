#include "bench/load/site.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <set>
#include <utility>

#include "datasets/depth_camera.hpp"
#include "datasets/place.hpp"
#include "datasets/scanner.hpp"
#include "datasets/sensor_poses.hpp"
#include "datasets/subsample.hpp"
#include "engine/base/error.hpp"
#include "engine/retrieval/describe_scene.hpp"
#include "engine/retrieval/scene_index.hpp"
#include "store/store.hpp"

namespace landmarkdb::bench {
namespace {

datasets::Place place_of(const SiteOptions& options, std::size_t number) {
  const auto types = datasets::all_place_types();
  datasets::PlaceOptions place;
  place.type = types[number % types.size()];
  place.seed = options.seed + number;
  place.size = options.size;
  place.floors = 1;
  return datasets::make_place(place);
}

SceneRecord describe_place(const SiteOptions& options,
                           std::size_t number,
                           const RunContext& context) {
  const datasets::Place place = place_of(options, number);
  datasets::ScannerOptions scanner;
  scanner.points = options.points;
  scanner.seed = options.seed + number;
  std::vector<Scan> scans(1);
  scans[0].cloud = datasets::merge_stations(datasets::scan_place(place, scanner, context));
  IndexOptions index;
  index.up = place.up;
  return describe_scene(place_name(number), std::move(scans), index, context);
}

// Which of the first `places` are there; refuses a file that holds anything else.
std::set<std::string> stored_places(const Store& store,
                                    const std::string& path,
                                    std::size_t places) {
  std::set<std::string> stored;
  for (const SceneSummary& scene : store.list_scenes()) stored.insert(scene.name);
  std::size_t known = 0;
  for (std::size_t i = 0; i < places; ++i) known += stored.count(place_name(i));
  if (known == stored.size()) return stored;
  throw Error(ErrorCode::kInvalidArgument,
              path + " holds " + std::to_string(stored.size()) + " scenes, " +
                  std::to_string(known) + " of them of the " + std::to_string(places) +
                  " places that are wanted: name another file");
}

}  // namespace

std::string place_name(std::size_t number) {
  std::string digits = std::to_string(number);
  constexpr std::size_t kDigits = 4;  // of 1,000 places
  digits.insert(0, kDigits - std::min(kDigits, digits.size()), '0');
  return "place-" + digits;
}

std::size_t fill_database(const std::string& path,
                          const SiteOptions& options,
                          std::size_t places,
                          double most_seconds,
                          const RunContext& context) {
  const auto start = std::chrono::steady_clock::now();
  Store store = Store::create_or_open(path);
  std::set<std::string> stored = stored_places(store, path, places);
  std::size_t made = 0;
  for (std::size_t i = 0; i < places; ++i) {
    if (stored.contains(place_name(i))) continue;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (took.count() > most_seconds) break;
    store.insert(
        describe_place(options, i, context), context, {make_scene_index, scene_index_format()});
    stored.insert(place_name(i));
    ++made;
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::fprintf(
      stderr, "%zu places, %zu of them made in %.1f s\n", stored.size(), made, took.count());
  store.checkpoint();
  return stored.size();
}

std::vector<SiteFrame> take_frames(const SiteOptions& options,
                                   std::size_t places,
                                   std::size_t count,
                                   std::size_t points,
                                   const RunContext& context) {
  std::vector<SiteFrame> frames(count);
  for (std::size_t p = 0; p < std::min(places, count); ++p) {
    const datasets::Place place = place_of(options, p);
    const std::size_t here = (count - p + places - 1) / places;
    const auto poses = datasets::sample_camera_poses(place, here, options.seed);
    for (std::size_t f = 0; f < here; ++f) {
      datasets::DepthCameraOptions camera;
      camera.seed = options.seed + p + f * places;
      const datasets::DepthFrame frame = datasets::render_depth(place, poses[f], camera, context);
      SiteFrame& taken = frames[p + f * places];
      taken.place = place_name(p);
      taken.cloud = datasets::subsample(frame.cloud, std::min(points, frame.valid), camera.seed);
      taken.T_scene_camera = frame.T_scene_camera;
    }
  }
  return frames;
}

}  // namespace landmarkdb::bench
