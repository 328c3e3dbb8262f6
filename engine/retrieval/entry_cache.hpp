#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "engine/base/error.hpp"
#include "engine/base/run_context.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/types/scene_source.hpp"

namespace landmarkdb {

// A catalogue's entries in memory, some of them only while they are used.
//
// An entry whose record is whole is kept for good. Of one that has a source there is an outline
// (its keypoints and wide grid) until somebody wants more; what was loaded is
// kept up to `most_bytes`, that not used for longest is let go first, and lives on with who holds
// it. An entry that turns out to be damaged is set aside: it is not loaded again. Thread-safe; one
// thread loads an entry while others that want it wait.
class EntryCache {
 public:
  using OnDamaged = std::function<void(const CatalogEntry& entry, const std::string& what)>;

  // `base`: whole entries and outlines. `on_damaged` (may be empty) is called once an entry.
  EntryCache(std::vector<std::shared_ptr<const Entry>> base,
             std::size_t most_bytes,
             OnDamaged on_damaged = {});

  std::size_t size() const { return base_.size(); }
  // As it was given: stays where it is for as long as the cache lives.
  const std::shared_ptr<const Entry>& base(std::size_t i) const { return base_[i]; }

  // The entry with at least these parts. Throws Error{kDataLoss} for a damaged
  // one, what its source and `context` throw.
  std::shared_ptr<const Entry> get(std::size_t i, SceneParts parts, const RunContext& context);

  // What is wrong with the entry; empty: nothing known.
  std::string damage(std::size_t i) const;
  void set_aside(std::size_t i, const std::string& what);

  std::size_t bytes() const;     // of what is loaded and kept
  std::uint64_t loads() const;   // so far
  std::uint64_t let_go() const;  // of these, for want of room

 private:
  struct Slot {
    std::mutex loading;
    // The rest is guarded by the cache's mutex.
    std::shared_ptr<const Entry> entry;
    SceneParts parts = SceneParts::kSurface;
    std::size_t bytes = 0;
    std::list<std::size_t>::iterator used;  // in `used_`, where there is an entry
    std::string damage;
  };

  std::shared_ptr<const Entry> find(std::size_t i, SceneParts parts);
  void keep(std::size_t i, SceneParts parts, const std::shared_ptr<const Entry>& entry);

  std::vector<std::shared_ptr<const Entry>> base_;
  std::vector<std::unique_ptr<Slot>> slots_;
  std::size_t most_bytes_;
  OnDamaged on_damaged_;
  mutable std::mutex mutex_;     // of all below, and of the slots
  std::list<std::size_t> used_;  // last used first
  std::size_t bytes_ = 0;
  std::uint64_t loads_ = 0, let_go_ = 0;
};

// Whether the scene itself cannot be served, and will not be next time (damaged, of a newer
// version, too large for a grid), so that the others can; not so a request to stop, or a database
// that cannot be read.
bool is_damage(const Error& error);

// What the entry takes, roughly: its points, grids and what of its record is loaded, and its
// surface for sight, whether that was made yet or not.
std::size_t memory_bytes(const Entry& entry);

}  // namespace landmarkdb
