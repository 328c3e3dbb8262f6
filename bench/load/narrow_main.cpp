// Whether the right one is among the places that a query looks at closely, by how many it may be.

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

// The right place's rank by score, from 1; 0: it has no match.
std::size_t rank_of(const std::string& place,
                    const Entries& entries,
                    const std::vector<EntryMatches>& matches,
                    const std::vector<double>& scores) {
  for (std::size_t m = 0; m < matches.size(); ++m) {
    if (entries[matches[m].entry].record().name != place) continue;
    return 1 + static_cast<std::size_t>(std::count_if(
                   scores.begin(), scores.end(), [&](double other) { return other > scores[m]; }));
  }
  return 0;
}

int run(const std::string& db, const SiteOptions& site, std::size_t places, std::size_t frames) {
  RunContext context;
  context.threads = 2;
  const auto catalog = Store::open_read_only(db).load_outlines(context);
  std::vector<std::shared_ptr<const Entry>> base;
  for (CatalogEntry stored : catalog->entries) {
    stored.record = stored.source->load(SceneParts::kSurface, context);
    base.push_back(std::make_shared<const Entry>(make_outline(std::move(stored))));
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
    SearchResult result;
    match_places(input, result);
    ranks.push_back(
        rank_of(frame.place, entries, result.matches, place_scores(input, result.matches)));
    std::printf("%s %zu keypoints, %zu places with matches, rank %zu\n",
                frame.place.c_str(),
                views.keypoints(),
                result.matches.size(),
                ranks.back());
    std::fflush(stdout);
  }
  std::printf("| places kept | the right one among them |\n| --- | --- |\n");
  for (const std::size_t kept : {1U, 4U, 8U, 16U, 24U, 32U, 48U, 64U, 128U}) {
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
  CLI::App app{"The rank of the right place among all of a database that bench-scale made"};
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
