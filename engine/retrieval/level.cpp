#include "engine/retrieval/level.hpp"

#include <algorithm>

namespace landmarkdb {

std::size_t Level::entry_of_row(std::size_t row) const {
  const auto above = std::upper_bound(first_row.begin(), first_row.end(), row);
  return static_cast<std::size_t>(above - first_row.begin()) - 1;
}

Level make_level(std::span<const Entry> entries, std::span<const std::size_t> chosen) {
  Level level{.options = {}, .entries = {}, .first_row = {0}, .values = {}, .index = {}};
  std::size_t numbers = 0;
  for (const std::size_t entry : chosen) {
    numbers += entries[entry].record().descriptors.values.size();
  }
  level.values.reserve(numbers);  // gigabytes for a thousand places: grown, it would hold two
  for (const std::size_t entry : chosen) {
    level.options = entries[entry].record().options;
    const std::vector<float>& values = entries[entry].record().descriptors.values;
    level.entries.push_back(entry);
    level.values.insert(level.values.end(), values.begin(), values.end());
    level.first_row.push_back(level.values.size() / kShotLength);
  }
  level.index = make_exact_index(level.values, Measure::kL2);
  return level;
}

std::vector<Level> make_levels(std::span<const Entry> entries, const RunContext& context) {
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
  std::vector<Level> levels;
  for (const std::vector<std::size_t>& group : groups) {
    context.check("index");
    levels.push_back(make_level(entries, group));
  }
  return levels;
}

}  // namespace landmarkdb
