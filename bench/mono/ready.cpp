#include "bench/mono/ready.hpp"

#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <string>
#include <utility>

#include <malloc.h>
#include <unistd.h>

#include "engine/mono/recognizer.hpp"
#include "engine/mono/search_tables.hpp"
#include "tests/support/make_mono_scene.hpp"

namespace landmarkdb::bench {
namespace {

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double resident_mb() {
  malloc_trim(0);
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

nlohmann::json ready(const Settings& settings) {
  auto catalog = std::make_shared<MonoCatalog>();
  double stored_mb = 0.0;
  for (std::size_t i = 0; i < settings.models; ++i) {
    MonoCatalogEntry entry;
    entry.model_id = static_cast<std::int64_t>(i) + 1;
    MonoModel model = testing::make_mono_model({.seed = settings.seed + i})->model;
    model.name = "model" + std::to_string(i);
    auto record = std::make_shared<MonoModelRecord>(derive_record(std::move(model)));
    stored_mb += static_cast<double>(record->index->quads.size()) / 1e6;
    entry.record = record;
    catalog->entries.push_back(entry);
  }
  const double before_mb = resident_mb(), begin = cpu_s();
  const Recognizer recognizer(catalog);
  const double ready_s = cpu_s() - begin, ready_mb = resident_mb() - before_mb;
  const testing::MonoScene scene =
      testing::make_mono_scene(catalog->entries[0].record.get(), {.links = false});
  const double asked = cpu_s();
  recognizer.recognize(scene.features, scene.camera, {}, {});
  const double first_s = cpu_s() - asked, all_mb = resident_mb() - before_mb;
  std::printf("%zu models, %.1f MB of stored indices: ready after %.2f s, %.0f MB\n",
              settings.models,
              stored_mb,
              ready_s,
              ready_mb);
  std::printf("the first image without links: %.2f s, then %.0f MB\n", first_s, all_mb);
  return {{"models", settings.models},
          {"stored_mb", stored_mb},
          {"ready_s", ready_s},
          {"ready_mb", ready_mb},
          {"first_without_links_s", first_s},
          {"all_mb", all_mb}};
}

}  // namespace landmarkdb::bench
