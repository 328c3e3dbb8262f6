#pragma once

#include <memory>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/types/point_cloud.hpp"
#include "engine/types/query.hpp"
#include "engine/types/scene_record.hpp"

namespace landmarkdb {

// Answers "which stored scene or object is this, and where in it is the sensor" against one
// catalogue.
//
// Never changes once built; query() is thread-safe. Building it derives what the search needs from
// each record (descriptor index, verification grid).
class Localizer {
 public:
  Localizer(std::shared_ptr<const Catalog> catalog, const RunContext& context);
  ~Localizer();
  Localizer(const Localizer&) = delete;
  Localizer& operator=(const Localizer&) = delete;

  // `clouds`: one in the sensor frame, metres, as the sensor gave it (NaN allowed), or several with
  // their poses in a frame they share, which then stands for the sensor frame. "Not found" is a
  // result with the stage that had nothing left. Throws Error{kInvalidArgument} for options that
  // cannot be (a scene name that is not in the catalogue is kNotFound), Error{kCancelled} or
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

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace landmarkdb
