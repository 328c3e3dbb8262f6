#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// What of its catalogue a Localizer keeps in memory, and whom it tells of damage.
struct LocalizerOptions {
  // Of scenes that have a source and are too many to be kept whole, what was loaded for queries.
  std::size_t scene_memory_bytes = std::size_t{1} << 30U;
  // Levels of more rows are searched by their nearest lists (level.hpp); 0: the usual number.
  std::size_t most_scanned_rows = 0;
  // Called once for each scene that turns out to be damaged when it is read; may be empty.
  std::function<void(const CatalogEntry&, const std::string&)> on_damaged{};
};

// What a Localizer has loaded for queries.
struct LoadedScenes {
  std::size_t scenes = 0;    // of the catalogue, those that are read on demand
  std::size_t bytes = 0;     // of them in memory, beside what queries hold
  std::uint64_t loads = 0;   // so far
  std::uint64_t let_go = 0;  // of these, for want of room
};

// Answers "which stored scene or object is this, and where in it is the sensor" against one
// catalogue.
//
// Never changes once built, but for which scenes are in memory; query() is thread-safe and its
// answer does not depend on that. Building it derives what the search needs from each record
// (descriptor index, verification grid); of scenes that have a source and are too many to be
// scanned the codes, keypoints and wide grids are kept, the rest is read when a query
// looks at them closely. A scene that turns out to be damaged then answers nothing any more.
class Localizer {
 public:
  Localizer(std::shared_ptr<const Catalog> catalog,
            const RunContext& context,
            const LocalizerOptions& options = {});
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  // `clouds`: one in the sensor frame, metres, as the sensor gave it (NaN allowed), or several with
  // their poses in a frame they share, which then stands for the sensor frame. "Not found" is a
  // result with the stage that had nothing left. Throws Error{kInvalidArgument} for options that
  // cannot be (a scene name that is not in the catalogue is kNotFound, of one that is set aside
  // kDataLoss), Error{kUnavailable} where a scene cannot be read now, Error{kCancelled} or
  // Error{kDeadlineExceeded} from `context`. Same cloud, options and seed: the same answer but for
  // the timings, whatever `context.threads` is.
  QueryResult query(std::vector<QueryCloud> clouds,
                    const QueryOptions& options,
                    const RunContext& context) const;

  // The same for one cloud.
  QueryResult query(const PointCloud& cloud,
                    const QueryOptions& options,
                    const RunContext& context) const;

  const Catalog& catalog() const;

  // Indices of the catalogue's entries that are set aside, and why. Thread-safe.
  std::vector<std::pair<std::size_t, std::string>> damaged() const;
  LoadedScenes loaded() const;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace landmarkdb
