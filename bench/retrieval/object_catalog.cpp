#include "bench/retrieval/object_catalog.hpp"

#include <algorithm>
#include <utility>

#include "engine/base/random.hpp"
#include "engine/retrieval/describe_scene.hpp"

namespace landmarkdb::bench {

namespace {

datasets::ObjectScanOptions draw_scan(datasets::ObjectGround ground, Random& random) {
  datasets::ObjectScanOptions scan;
  const double views = random.uniform();
  scan.views = views < 0.5    ? datasets::ObjectViews::kAround
               : views < 0.85 ? datasets::ObjectViews::kTurntable
                              : datasets::ObjectViews::kFront;
  scan.noise_m = random.uniform(0.0003, 0.0015);
  if (ground == datasets::ObjectGround::kFloor) scan.noise_m *= 3.0;
  scan.keep_viewpoints = random.uniform() < 0.5;
  scan.seed = random.next();
  return scan;
}

CatalogEntry index_object(const datasets::ObjectModel& model,
                          const datasets::ObjectScanOptions& scan,
                          std::size_t number,
                          const RunContext& context) {
  std::vector<Scan> scans(1);
  scans[0].cloud = datasets::scan_object(model, scan, context);
  IndexOptions options;
  options.kind = EntryKind::kObject;
  CatalogEntry entry;
  entry.scene_id = static_cast<std::int64_t>(number) + 1;
  entry.version = 1;
  entry.record =
      std::make_shared<SceneRecord>(describe_scene(model.name, std::move(scans), options, context));
  return entry;
}

}  // namespace

ObjectCatalog make_object_catalog(const ObjectCatalogOptions& options, const RunContext& context) {
  constexpr std::uint64_t kSeedsEach = 1000;
  ObjectCatalog made;
  made.ground = options.ground;
  const auto kinds = options.ground == datasets::ObjectGround::kTable ? datasets::table_objects()
                                                                      : datasets::floor_objects();
  Random random(options.seed);
  const std::size_t first = random.below(kinds.size());
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.objects); ++i) {
    datasets::ObjectOptions object{.kind = kinds[(first + i) % kinds.size()],
                                   .seed = options.seed * kSeedsEach + i};
    if (i % 4 == 3) {
      object = made.known.back().options;
      object.twin = 1;
    }
    made.known.push_back(datasets::make_object(object));
    made.catalog->entries.push_back(
        index_object(made.known.back(), draw_scan(options.ground, random), i, context));
  }
  for (std::size_t i = 0; i < made.known.size(); ++i) {
    datasets::ObjectOptions twin = made.known[i].options;
    twin.twin += 10;
    made.strangers.push_back(datasets::make_object(twin));
  }
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    made.strangers.push_back(datasets::make_object(
        {.kind = kinds[i], .seed = options.seed * kSeedsEach + kSeedsEach / 2 + i}));
  }
  return made;
}

AskedScene make_asked_scene(const ObjectCatalog& objects,
                            std::size_t number,
                            std::uint64_t seed,
                            const RunContext& context) {
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15ULL;
  Random random(seed + kStep * (number + 1));
  AskedScene asked;
  const std::size_t instances = number % 4 == 0 ? 0 : number % 4 == 3 ? 2 + random.below(2) : 1;
  for (std::size_t i = 0; i < instances; ++i) {
    const bool again = i > 0 && random.uniform() < 0.4;
    asked.models.push_back(again ? asked.models.back()
                                 : &objects.known[random.below(objects.known.size())]);
  }
  asked.known = instances;
  const std::size_t clutter = 3 + random.below(5);
  for (std::size_t i = 0; i < clutter; ++i) {
    asked.models.push_back(&objects.strangers[random.below(objects.strangers.size())]);
  }
  asked.options.ground = objects.ground;
  asked.options.sensor = random.uniform() < 0.5 ? datasets::ObjectSensor::kDepthCamera
                                                : datasets::ObjectSensor::kScanner;
  asked.options.crowding = random.uniform();
  asked.options.seed = random.next();
  asked.scene = datasets::make_object_scene(asked.models, asked.options, context);
  return asked;
}

}  // namespace landmarkdb::bench
