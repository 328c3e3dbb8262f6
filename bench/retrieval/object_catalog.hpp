#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "datasets/objects/object_scene.hpp"
#include "engine/base/run_context.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb::bench {

// A catalogue of generated objects, and others of the same kinds that are not in it.
struct ObjectCatalog {
  datasets::ObjectGround ground = datasets::ObjectGround::kTable;
  std::vector<datasets::ObjectModel> known;      // in the order of the catalogue's entries
  std::vector<datasets::ObjectModel> strangers;  // first a look-alike of each known one
  std::shared_ptr<Catalog> catalog = std::make_shared<Catalog>();
};

struct ObjectCatalogOptions {
  int objects = 6;
  std::uint64_t seed = 1000;
  datasets::ObjectGround ground = datasets::ObjectGround::kTable;
};

// Scans and indexes them: from all sides, on a turntable or from the front, with noise of 0.3 to
// 1.5 mm, with viewpoints or without, drawn from the seed. Every fourth is a look-alike of the one
// before.
ObjectCatalog make_object_catalog(const ObjectCatalogOptions& options, const RunContext& context);

// A scene of the catalogue: every fourth without any of its objects, every fourth with two or three
// (some twice), the others with one; three to seven strangers among them. `models` are the things
// in the order laid out, the known ones first.
struct AskedScene {
  std::vector<const datasets::ObjectModel*> models;
  std::size_t known = 0;  // of `models`
  datasets::ObjectSceneOptions options;
  datasets::ObjectScene scene;
};
AskedScene make_asked_scene(const ObjectCatalog& objects,
                            std::size_t number,
                            std::uint64_t seed,
                            const RunContext& context);

}  // namespace landmarkdb::bench
