// Whether the right one is among the places that a query looks at closely, by how many of a level
// these may be.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/load/site.hpp"
#include "engine/retrieval/narrow_places.hpp"
#include "engine/retrieval/search.hpp"
#include "store/store.hpp"

namespace landmarkdb::bench {
namespace {

// The right place's rank by score among those of its level, from 1; 0: the frame cannot be
// described as that level is.
std::size_t rank_of(const std::string& place, const SearchInput& input) {
  for (const Level& level : input.levels) {
    const auto right = std::find_if(level.entries.begin(), level.entries.end(), [&](std::size_t e) {
      return input.entries[e].record().name == place;
    });
    if (right == level.entries.end()) continue;
    const QueryView& view = input.views.at(level.options);
    if (view.descriptors.size() == 0) return 0;
    const std::vector<PlaceScore> scores = place_scores(input, level, view);
    const auto own = std::find_if(
        scores.begin(), scores.end(), [&](const PlaceScore& one) { return one.entry == *right; });
    return 1 + static_cast<std::size_t>(
                   std::count_if(scores.begin(), scores.end(), [&](const PlaceScore& other) {
                     return other.score > own->score;
                   }));
  }
  return 0;
}

int run(const std::string& db, const SiteOptions& site, std::size_t places, std::size_t frames) {
  RunContext context;
  context.threads = 2;
  const auto catalog = Store::open_read_only(db).load_outlines(context);
  std::vector<std::shared_ptr<const Entry>> base;
  for (CatalogEntry stored : catalog->entries) {
    PlaceOutline outline = make_place_outline(*stored.source->load(SceneParts::kSurface, context));
    base.push_back(
        std::make_shared<const Entry>(make_outline(std::move(stored), std::move(outline))));
  }
  EntryCache cache(std::move(base), 0);
  const std::vector<Level> levels = make_levels(Entries(cache), context, 1);
  std::vector<std::size_t> ranks;
  for (const SiteFrame& frame : take_frames(site, places, frames, 0, context)) {
    Entries entries(cache);
    const QueryOptions options;
    StageTimings timings;
    const CleanQuery query = clean_query(frame.cloud);
    ViewCache views(query, options.seed, context, timings);
    const std::vector<bool> wanted(entries.size(), true);
    IndexCache indexes;
    const SearchInput input{
        query, options, entries, levels, wanted, views, indexes, timings, context};
    ranks.push_back(rank_of(frame.place, input));
    std::printf(
        "%s %zu keypoints, rank %zu\n", frame.place.c_str(), views.keypoints(), ranks.back());
    std::fflush(stdout);
  }
  std::printf("| places kept of a level | the right one among them |\n| --- | --- |\n");
  for (const std::size_t kept : {1U, 2U, 4U, 6U, 8U, 12U, 16U, 24U, 32U, 48U, 64U, 128U}) {
    const auto among = std::count_if(
        ranks.begin(), ranks.end(), [&](std::size_t rank) { return rank > 0 && rank <= kept; });
    std::printf("| %u | %td of %zu |\n", static_cast<unsigned>(kept), among, ranks.size());
  }
  return 0;
}

}  // namespace
}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  std::string db;
  landmarkdb::bench::SiteOptions site;
  std::size_t places = 10;
  std::size_t frames = 20;
  CLI::App app{
      "The rank of the right place among those of its level in a database that bench-scale made"};
  app.add_option("--db", db, "The database")->required()->check(CLI::ExistingFile);
  app.add_option("--seed", site.seed, "Of the first place")->capture_default_str();
  app.add_option("--asked", places, "Frames are of the first so many places in turn")
      ->capture_default_str();
  app.add_option("--frames", frames, "Frames")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(db, site, places, frames);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "landmarkdb-bench-narrow: %s\n", error.what());
    return 1;
  }
}
