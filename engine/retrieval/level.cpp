#include "engine/retrieval/level.hpp"

#include <algorithm>

namespace landmarkdb {

std::size_t Level::entry_of_row(std::size_t row) const {
  const auto above = std::upper_bound(first_row.begin(), first_row.end(), row);
  return static_cast<std::size_t>(above - first_row.begin()) - 1;
}

std::vector<Level> make_levels(std::span<const Entry> entries) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].is_object()) continue;
    const FeatureOptions& options = entries[i].record().options;
    auto level = std::find_if(
        levels.begin(), levels.end(), [&](const Level& other) { return other.options == options; });
    if (level == levels.end()) {
      levels.push_back(
          Level{.options = options, .entries = {}, .first_row = {0}, .values = {}, .index = {}});
      level = levels.end() - 1;
    }
    const std::vector<float>& values = entries[i].record().descriptors.values;
    level->entries.push_back(i);
    level->values.insert(level->values.end(), values.begin(), values.end());
    level->first_row.push_back(level->values.size() / kShotLength);
  }
  for (Level& level : levels) level.index = make_exact_index(level.values, Measure::kL2);
  return levels;
}

}  // namespace landmarkdb
