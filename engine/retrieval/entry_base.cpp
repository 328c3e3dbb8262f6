#include "engine/retrieval/entry_base.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/retrieval/entry_cache.hpp"
#include "engine/retrieval/level.hpp"
#include "engine/retrieval/scene_index.hpp"

namespace landmarkdb {

namespace {

// Side by side, and some at a time, so that progress is told between them. `make(i)` fills in
// which[i].
template <typename Make>
void for_each_entry(std::span<const std::size_t> which,
                    const RunContext& context,
                    const Make& make) {
  constexpr std::size_t kAtATime = 64;  // for each thread
  const std::size_t step = kAtATime * static_cast<std::size_t>(std::max(context.threads, 1));
  for (std::size_t first = 0; first < which.size(); first += step) {
    context.report("index", first, which.size());
    const std::size_t count = std::min(step, which.size() - first);
    parallel_each(count, context.threads, [&](std::size_t i) { make(which[first + i]); });
  }
}

// The entries that are kept whole: objects, and the places of levels that are scanned.
std::vector<std::size_t> kept_whole(const Entries& entries, std::size_t most_scanned_rows) {
  std::vector<std::size_t> whole;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].is_object()) whole.push_back(i);
  }
  for (const std::vector<std::size_t>& group : group_places(entries)) {
    if (rows_of(entries, group) > most_scanned_rows) continue;
    whole.insert(whole.end(), group.begin(), group.end());
  }
  std::sort(whole.begin(), whole.end());
  return whole;
}

// Of each entry, whether its level wants the tails of its codes.
std::vector<bool> tails_kept(const Entries& entries) {
  std::vector<bool> kept(entries.size(), true);
  for (const std::vector<std::size_t>& group : group_places(entries)) {
    const bool keeps = keeps_tails(group.size(), rows_of(entries, group));
    for (const std::size_t i : group) kept[i] = keeps;
  }
  return kept;
}

// An entry that is kept for good, with all that is made when it is asked for.
std::shared_ptr<const Entry> whole_entry(CatalogEntry stored, const RunContext& context) {
  auto entry = std::make_shared<const Entry>(make_entry(std::move(stored), context));
  entry->sight.get(context.threads);
  entry->planes.get();
  return entry;
}

// Of a place that is read when it is looked at closely: what is stored with it for that, or, with
// none, made from its points.
void add_outline(CatalogEntry stored,
                 bool with_tails,
                 const RunContext& context,
                 std::shared_ptr<const Entry>& entry,
                 std::optional<EntryCodes>& codes) {
  const auto rows = static_cast<std::size_t>(stored.keypoints);
  std::optional<SceneIndex> index = scene_index_of(stored, with_tails, context);
  if (index) {
    codes = EntryCodes(index->codes, rows, with_tails);
  } else {
    index.emplace().outline =
        make_place_outline(*stored.source->load(SceneParts::kSurface, context));
  }
  entry = std::make_shared<const Entry>(make_outline(std::move(stored), std::move(index->outline)));
}

}  // namespace

EntryBase make_entry_base(const Catalog& catalog,
                          std::size_t most_scanned_rows,
                          const RunContext& context) {
  EntryBase base;
  base.damage.resize(catalog.entries.size());
  std::vector<std::size_t> in_memory;
  for (std::size_t i = 0; i < catalog.entries.size(); ++i) {
    base.entries.push_back(std::make_shared<const Entry>(make_outline(catalog.entries[i])));
    if (catalog.entries[i].source == nullptr) in_memory.push_back(i);
  }
  for_each_entry(in_memory, context, [&](std::size_t i) {
    base.entries[i] = whole_entry(catalog.entries[i], context);
  });
  EntryCache outlines(base.entries, 0);
  std::vector<bool> whole(catalog.entries.size(), false);
  for (const std::size_t i : kept_whole(Entries(outlines), most_scanned_rows)) whole[i] = true;
  const std::vector<bool> with_tails = tails_kept(Entries(outlines));
  base.codes.resize(catalog.entries.size());
  std::vector<std::size_t> to_read;
  for (std::size_t i = 0; i < catalog.entries.size(); ++i) {
    if (catalog.entries[i].source != nullptr) to_read.push_back(i);
  }
  RunContext alone = context;
  alone.threads = 1;
  alone.progress = nullptr;
  for_each_entry(to_read, context, [&](std::size_t i) {
    CatalogEntry stored = catalog.entries[i];
    try {
      if (!whole[i]) {
        add_outline(std::move(stored), with_tails[i], alone, base.entries[i], base.codes[i]);
        return;
      }
      stored.record = stored.source->load(SceneParts::kWhole, alone);
      stored.source = nullptr;  // there is nothing left to be read
      base.entries[i] = whole_entry(std::move(stored), alone);
    } catch (const Error& error) {
      if (!is_damage(error)) throw;
      base.damage[i] = error.what();
    }
  });
  return base;
}

}  // namespace landmarkdb
