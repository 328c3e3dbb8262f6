#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/base/run_context.hpp"
#include "engine/matching/coded_index.hpp"
#include "engine/retrieval/entries.hpp"
#include "engine/types/correspondence.hpp"
#include "engine/types/descriptor_codes.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// The places described alike: one descriptor index over all of them, entry and row beside each
// match, so that a query is described and searched once a level, not once a place.
struct Level {
  FeatureOptions options;
  std::vector<std::size_t> entries;    // indices into the localizer's entries, ascending
  std::vector<std::size_t> first_row;  // of each entry, and the number of rows at the end
  // By l2 distance, from codes alone: the distances are those of the codes.
  std::unique_ptr<CodedIndex> index;
  bool scanned = true;  // every code is compared, not those of the nearest lists alone

  std::size_t rows() const { return first_row.back(); }
  // Which of `entries` a row belongs to.
  std::size_t entry_of_row(std::size_t row) const;
};

// A level of up to so many rows is scanned: every code is compared, and its entries are kept in
// memory whole. In more the nearest lists are cheaper by half and more (docs/performance.md).
inline constexpr std::size_t kMostScannedRows = 65'536;

// Up to so many places are all looked at closely; of more, those that seem likely
// (narrow_places.hpp).
inline constexpr std::size_t kAllPlaces = 16;

// A level of more rows and places is searched to find out which places are worth a closer look, and
// these by all of their codes: tails, as long as the codes, would show no other places
// (docs/decisions/0025).
inline constexpr std::size_t kMostRowsWithTails = std::size_t{1} << 20U;
bool keeps_tails(std::size_t places, std::size_t rows);

// The codes of an entry as its level's index takes them.
struct EntryCodes {
  // Throws what make_coded_part does.
  EntryCodes(const DescriptorCodes& codes, std::size_t rows, bool with_tails);

  std::shared_ptr<const CodedPart> part;
  std::vector<std::int8_t> tails;  // by row; empty: not wanted
};

// Gives away the codes of an entry that were read with something else of it; nothing where they
// were not.
using CodesAtHand = std::function<std::optional<EntryCodes>(std::size_t entry)>;

// How many descriptors the entry has, whether they are in memory or not.
std::size_t rows_of(const Entry& entry);
std::size_t rows_of(const Entries& entries, std::span<const std::size_t> chosen);  // of all these

// The places by their feature options, in order of first appearance, indices ascending. Objects are
// in no group: they are looked for in the query, not the query in them.
std::vector<std::vector<std::size_t>> group_places(const Entries& entries);

// A level for each group. The codes of a level that is scanned are made from its descriptors, which
// are read if they are not in memory; of others the stored codes are read, or made where there are
// none. Rows of entries that are damaged are there and like nothing. Throws what `context.check`
// does.
std::vector<Level> make_levels(const Entries& entries,
                               const RunContext& context = {},
                               std::size_t most_scanned_rows = kMostScannedRows,
                               const CodesAtHand& at_hand = {});

// The level of some of these entries alone (indices, ascending, all places described alike): what
// is asked of named scenes must not depend on the others.
Level make_level(const Entries& entries,
                 std::span<const std::size_t> chosen,
                 const RunContext& context = {},
                 std::size_t most_scanned_rows = kMostScannedRows,
                 const CodesAtHand& at_hand = {});

// What was found in the level's index, k neighbours a query, sorted out by entry, in the order of
// its entries; `target` is a keypoint of the entry.
std::vector<std::vector<Correspondence>> sort_out_matches(const Level& level,
                                                          std::span<const DescriptorMatch> found,
                                                          std::size_t k);

// The descriptors of the level's entries one behind the other, read where they are not in memory.
std::vector<float> level_values(const Entries& entries,
                                std::span<const std::size_t> chosen,
                                const RunContext& context);

}  // namespace landmarkdb
