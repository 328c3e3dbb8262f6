#include "engine/retrieval/level.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"
#include "engine/matching/coded_index.hpp"
#include "engine/matching/make_codes.hpp"
#include "engine/retrieval/scene_index.hpp"

namespace landmarkdb {

namespace {

// The entry's descriptors: `held` keeps them where they had to be read. Empty for a damaged one.
std::span<const float> values_of(const Entry& entry,
                                 const RunContext& context,
                                 std::shared_ptr<const SceneRecord>& held) {
  const std::vector<float>& values = entry.record().descriptors.values;
  if (!values.empty() || entry.stored.source == nullptr) return values;
  try {
    held = entry.stored.source->load(SceneParts::kWhole, context);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kDataLoss && error.code() != ErrorCode::kUnimplemented) throw;
    return {};
  }
  return held->descriptors.values;
}

// Rows whose codes lie where no descriptor's do: farther from every query than those of others.
DescriptorCodes blank_codes(std::size_t rows) {
  DescriptorCodes codes;
  if (rows == 0) return codes;
  constexpr std::int8_t kOutermost = std::numeric_limits<std::int8_t>::max();
  codes.centres.assign(kCodeLength, kOutermost);
  codes.list_start = {0, static_cast<std::uint32_t>(rows)};
  for (std::size_t row = 0; row < rows; ++row)
    codes.rows.push_back(static_cast<std::uint32_t>(row));
  codes.codes.assign(rows * kCodeLength, kOutermost);
  codes.tails.assign(rows * kCodeLength, kOutermost);
  return codes;
}

// In lists of what is alike, or, to be scanned, in order.
DescriptorCodes codes_of(const Entry& entry,
                         bool scanned,
                         bool with_tails,
                         const RunContext& context) {
  const std::size_t rows = rows_of(entry);
  if (entry.stored.source != nullptr) {
    std::optional<SceneIndex> stored = scene_index_of(entry.stored, with_tails, context);
    if (stored) return std::move(stored->codes);
  }
  std::shared_ptr<const SceneRecord> held;
  const std::span<const float> values = values_of(entry, context, held);
  if (values.size() != rows * kShotLength) return blank_codes(rows);
  return scanned ? make_codes_in_order(values, context) : make_codes(values, context);
}

// Codes are made or read side by side, each entry's by one thread, and a few at a time: tails are
// in memory twice only for as long as they are added.
std::unique_ptr<CodedIndex> make_index_of_codes(const Entries& entries,
                                                std::span<const std::size_t> chosen,
                                                bool scanned,
                                                const CodedSearchOptions& options,
                                                const CodesAtHand& at_hand,
                                                const RunContext& context) {
  constexpr std::size_t kAtATime = 64;
  CodedIndexMaker maker(options, rows_of(entries, chosen));
  RunContext alone = context;
  if (chosen.size() > 1) {
    alone.threads = 1;
    alone.progress = nullptr;
  }
  for (std::size_t first = 0; first < chosen.size(); first += kAtATime) {
    context.report("index", first, chosen.size());
    std::vector<std::optional<EntryCodes>> codes(std::min(kAtATime, chosen.size() - first));
    parallel_each(codes.size(), context.threads, [&](std::size_t i) {
      const Entry& entry = entries[chosen[first + i]];
      if (at_hand) codes[i] = at_hand(chosen[first + i]);
      if (codes[i]) return;
      codes[i].emplace(codes_of(entry, scanned, options.keeps_tails, alone),
                       rows_of(entry),
                       options.keeps_tails);
    });
    for (const std::optional<EntryCodes>& one : codes) maker.add({{}, one->part, one->tails});
  }
  return maker.finish();
}

CodedSearchOptions options_for(const Level& level) {
  if (level.scanned) return kScanOptions;
  return {.keeps_tails = keeps_tails(level.entries.size(), level.rows())};
}

}  // namespace

EntryCodes::EntryCodes(const DescriptorCodes& codes, std::size_t rows, bool with_tails)
    : part(make_coded_part(codes, rows)) {
  if (with_tails) tails = tails_by_row(codes);
}

std::size_t Level::entry_of_row(std::size_t row) const {
  const auto above = std::upper_bound(first_row.begin(), first_row.end(), row);
  return static_cast<std::size_t>(above - first_row.begin()) - 1;
}

bool keeps_tails(std::size_t places, std::size_t rows) {
  return places <= kAllPlaces || rows <= kMostRowsWithTails;
}

std::size_t rows_of(const Entry& entry) {
  return entry.stored.source != nullptr ? static_cast<std::size_t>(entry.stored.keypoints)
                                        : entry.record().descriptors.size();
}

std::size_t rows_of(const Entries& entries, std::span<const std::size_t> chosen) {
  std::size_t rows = 0;
  for (const std::size_t entry : chosen) rows += rows_of(entries[entry]);
  return rows;
}

std::vector<float> level_values(const Entries& entries,
                                std::span<const std::size_t> chosen,
                                const RunContext& context) {
  std::vector<float> all;
  all.reserve(rows_of(entries, chosen) *
              kShotLength);  // gigabytes for a thousand places: grown, it would hold two
  std::size_t want = 0;
  for (const std::size_t entry : chosen) {
    context.check("load");
    std::shared_ptr<const SceneRecord> held;
    const std::span<const float> values = values_of(entries[entry], context, held);
    all.insert(all.end(), values.begin(), values.end());
    want += rows_of(entries[entry]) * kShotLength;
    all.resize(want);
  }
  return all;
}

Level make_level(const Entries& entries,
                 std::span<const std::size_t> chosen,
                 const RunContext& context,
                 std::size_t most_scanned_rows,
                 const CodesAtHand& at_hand) {
  Level level{.options = {}, .entries = {}, .first_row = {0}, .index = {}};
  for (const std::size_t entry : chosen) {
    level.options = entries[entry].record().options;
    level.entries.push_back(entry);
    level.first_row.push_back(level.first_row.back() + rows_of(entries[entry]));
  }
  level.scanned = level.rows() <= most_scanned_rows;
  level.index =
      make_index_of_codes(entries, chosen, level.scanned, options_for(level), at_hand, context);
  return level;
}

std::vector<std::vector<Correspondence>> sort_out_matches(const Level& level,
                                                          std::span<const DescriptorMatch> found,
                                                          std::size_t k) {
  std::vector<std::vector<Correspondence>> by_entry(level.entries.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].index == DescriptorMatch::kNone) continue;
    const std::size_t place = level.entry_of_row(found[i].index);
    by_entry[place].push_back({static_cast<std::uint32_t>(i / k),
                               static_cast<std::uint32_t>(found[i].index - level.first_row[place]),
                               found[i].distance});
  }
  return by_entry;
}

std::vector<std::vector<std::size_t>> group_places(const Entries& entries) {
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].is_object()) continue;
    const FeatureOptions& options = entries[i].record().options;
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const std::vector<std::size_t>& other) {
          return entries[other.front()].record().options == options;
        });
    if (group == groups.end()) group = groups.insert(groups.end(), std::vector<std::size_t>{});
    group->push_back(i);
  }
  return groups;
}

std::vector<Level> make_levels(const Entries& entries,
                               const RunContext& context,
                               std::size_t most_scanned_rows,
                               const CodesAtHand& at_hand) {
  std::vector<Level> levels;
  for (const std::vector<std::size_t>& group : group_places(entries)) {
    context.check("index");
    levels.push_back(make_level(entries, group, context, most_scanned_rows, at_hand));
  }
  return levels;
}

}  // namespace landmarkdb
