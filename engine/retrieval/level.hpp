#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/matching/descriptor_index.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// The places described alike: one descriptor index over all of them, entry and row beside each
// match, so that a query is described and searched once a level, not once a place.
struct Level {
  FeatureOptions options;
  std::vector<std::size_t> entries;        // indices into the localizer's entries, ascending
  std::vector<std::size_t> first_row;      // of each entry, and the number of rows at the end
  std::unique_ptr<DescriptorIndex> index;  // by l2 distance
  bool coded = false;  // the index holds codes only, and its distances are those of the codes

  std::size_t rows() const { return first_row.back(); }
  // Which of `entries` a row belongs to.
  std::size_t entry_of_row(std::size_t row) const;
};

// A level of up to so many rows is searched exactly, as one answer of a small catalogue is as
// another's; in more the codes are cheaper by half and more (docs/performance.md), and what is lost
// by them is less than what the bound on neighbours loses.
inline constexpr std::size_t kMostExactRows = 65'536;

// How many descriptors the entry has, whether they are in memory or not.
std::size_t rows_of(const Entry& entry);

// The places by their feature options, in order of first appearance, indices ascending. Objects are
// in no group: they are looked for in the query, not the query in them.
std::vector<std::vector<std::size_t>> group_places(const Entries& entries);

// A level for each group. Entries of a level that is searched exactly are read for it in full if
// they are not in memory, of others the codes alone; where none are stored they are made. Rows of
// entries that are damaged are there and like nothing. Throws what `context.check` does.
std::vector<Level> make_levels(const Entries& entries,
                               const RunContext& context = {},
                               std::size_t most_exact_rows = kMostExactRows);

// The level of some of these entries alone (indices, ascending, all places described alike): what
// is asked of named scenes must not depend on the others.
Level make_level(const Entries& entries,
                 std::span<const std::size_t> chosen,
                 const RunContext& context = {},
                 std::size_t most_exact_rows = kMostExactRows);

// The descriptors of the level's entries one behind the other, read where they are not in memory.
std::vector<float> level_values(const Entries& entries,
                                std::span<const std::size_t> chosen,
                                const RunContext& context);

}  // namespace landmarkdb
