#pragma once

#include <string>

#include "bench/retrieval/object_catalog.hpp"
#include "engine/types/query.hpp"

namespace landmarkdb::bench {

// One line for each instance of a known object in the scene: how many pairs proposed a pose near
// the true one, its place among the poses assessed (by score, -1: lost), its score and what the
// best pose at another spot of the same object has; and what the true pose itself scores.
std::string object_funnel_text(const ObjectCatalog& objects,
                               const AskedScene& asked,
                               const QueryOptions& options,
                               const RunContext& context);

}  // namespace landmarkdb::bench
