#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/retrieval/entry.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// The places described alike: one descriptor index over all of them, entry and row beside each
// match, so that a query is described and searched once a level, not once a place.
struct Level {
  FeatureOptions options;
  std::vector<std::size_t> entries;  // indices into the localizer's entries, ascending
  std::vector<std::size_t>
      first_row;              // of each entry in `values`, and the number of rows at the end
  std::vector<float> values;  // N x kShotLength
  std::unique_ptr<DescriptorIndex> index;  // over `values`

  // Which of `entries` a row belongs to.
  std::size_t entry_of_row(std::size_t row) const;
};

// Groups the places by their feature options, in order of first appearance. Objects are not in
// levels: they are looked for in the query, not the query in them. Throws what `context.check`
// does.
std::vector<Level> make_levels(std::span<const Entry> entries, const RunContext& context = {});

// The level of some of these entries alone (indices, ascending, all places described alike): what
// is asked of named scenes must not depend on the others.
Level make_level(std::span<const Entry> entries, std::span<const std::size_t> chosen);

}  // namespace landmarkdb
