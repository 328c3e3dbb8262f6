#include "client/choices.hpp"

#include <algorithm>

#include "cli/usage_error.hpp"

namespace landmarkdb::client {
namespace {

// The enumerators stand in the order of the names.
template <typename Enum>
Enum choose(const std::vector<std::string>& names,
            std::string_view word,
            const std::string& option) {
  const auto found = std::ranges::find(names, word);
  if (found != names.end()) return static_cast<Enum>(found - names.begin());
  std::string wanted;
  for (const std::string& name : names) wanted += (wanted.empty() ? "" : ", ") + name;
  throw cli::UsageError(option, "'" + std::string(word) + "' is none of " + wanted);
}

}  // namespace

KeypointMethod keypoint_method(std::string_view word, const std::string& option) {
  return choose<KeypointMethod>(kKeypointNames, word, option);
}

Measure measure(std::string_view word, const std::string& option) {
  return choose<Measure>(kMeasureNames, word, option);
}

std::vector<Filter> filters(std::string_view list, const std::string& option) {
  std::vector<Filter> out;
  for (;;) {
    const std::size_t comma = list.find(',');
    const auto filter = choose<Filter>(kFilterNames, list.substr(0, comma), option);
    if (std::ranges::find(out, filter) != out.end()) {
      throw cli::UsageError(option, "'" + std::string(list.substr(0, comma)) + "' stands twice");
    }
    out.push_back(filter);
    if (comma == std::string_view::npos) return out;
    list.remove_prefix(comma + 1);
  }
}

std::string_view name_of(KeypointMethod method) {
  return kKeypointNames.at(static_cast<std::size_t>(method));
}

std::string_view name_of(EntryKind kind) { return kKindNames.at(static_cast<std::size_t>(kind)); }

}  // namespace landmarkdb::client
