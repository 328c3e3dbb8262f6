#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/retrieval/entry_cache.hpp"

namespace landmarkdb {

// A catalogue's entries as one query sees them: an entry that is not in memory is an outline (its
// keypoints and wide grid) until the query loads it, and stays loaded for as long as the query
// lasts. Belongs to one thread, but for reading.
class Entries {
 public:
  Entries() = default;
  // Whole entries, which must outlive this.
  Entries(std::span<const Entry> whole);    // NOLINT(google-explicit-constructor)
  Entries(const std::vector<Entry>& whole)  // NOLINT(google-explicit-constructor)
      : Entries(std::span<const Entry>(whole)) {}
  // Those of the cache, which must outlive this.
  explicit Entries(EntryCache& cache);

  const Entry& operator[](std::size_t i) const { return *seen_[i]; }
  std::size_t size() const { return seen_.size(); }
  bool empty() const { return seen_.empty(); }

  // Something that stays where it is, and stands for entry i, whatever is loaded of it.
  const void* key(std::size_t i) const;
  bool is_damaged(std::size_t i) const;

  // Loads these entries, side by side. Those that are damaged stay outlines (is_damaged). Throws
  // what EntryCache::get does but for that.
  void load(std::span<const std::size_t> which, SceneParts parts, const RunContext& context);

 private:
  EntryCache* cache_ = nullptr;
  std::vector<const Entry*> seen_;
  std::vector<std::shared_ptr<const Entry>> held_;  // loaded ones that `seen_` points to
};

}  // namespace landmarkdb
