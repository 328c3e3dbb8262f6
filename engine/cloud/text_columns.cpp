#include "engine/cloud/text_columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>

#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMostColumns = 64;  // those beyond are not looked at

// Moves `at` to the next word; returns ',' or ';' or, without either, ' '.
char skip_separator(std::string_view line, std::size_t& at) {
  char found = ' ';
  for (; at < line.size(); ++at) {
    const char c = line[at];
    if (is_blank(c)) continue;
    if ((c != ',' && c != ';') || found != ' ') break;
    found = c;
  }
  return found;
}

struct Evidence {
  bool could_be_colour = true, could_be_normal = true;
};

// Looks at one group of three columns of one line.
void weigh(const std::vector<std::string_view>& words, std::size_t first, Evidence& evidence) {
  constexpr double kTolerance = 0.02;  // of a normal's length
  double squared = 0.0;
  for (std::size_t i = first; i < first + 3; ++i) {
    const std::optional<double> value = parse_number(words[i]);
    const std::optional<std::uint64_t> whole = parse_count(words[i]);
    if (!whole || *whole > 255) evidence.could_be_colour = false;
    squared += value ? *value * *value : std::numeric_limits<double>::quiet_NaN();
  }
  if (!(std::abs(std::sqrt(squared) - 1.0) <= kTolerance)) evidence.could_be_normal = false;
}

// The name without quotes and blanks, in small letters, up to a bracket with its unit.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name) {
    if (c == '[' || c == '(') break;
    if (c == '"' || c == '\'' || is_blank(c)) continue;
    plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return plain;
}

using Names = std::initializer_list<std::string_view>;

// The columns of three names, each of which may be one of several.
std::optional<TextLayout::Three> find_three(std::span<const std::string> names,
                                            const std::array<Names, 3>& wanted) {
  TextLayout::Three three{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto found = std::find_if(names.begin(), names.end(), [&](const std::string& name) {
      return std::find(wanted[k].begin(), wanted[k].end(), plain_name(name)) != wanted[k].end();
    });
    if (found == names.end()) return std::nullopt;
    three[k] = static_cast<std::size_t>(found - names.begin());
  }
  return three;
}

}  // namespace

bool is_comment(std::string_view line) {
  std::string_view rest = line;
  const std::string_view word = take_word(rest);
  return word.empty() || word.front() == '#' || word.starts_with("//");
}

void Splitter::split(std::string_view line, std::vector<std::string_view>& words) const {
  const auto at_line = [&] { return "line " + std::to_string(lines_.number()); };
  words.clear();
  char separator = '\0';
  std::size_t at = 0;
  while (words.size() < kMostColumns) {
    const char found = skip_separator(line, at);
    if (at == line.size()) return;
    if (!words.empty()) {
      if (separator == '\0') separator = found;
      if (found != separator) {
        refuse(input_,
               at_line() + " has two kinds of separators: " + in_quotes(line) +
                   " (decimal commas are not supported)");
      }
    }
    std::size_t end = at;
    while (end < line.size() && !is_blank(line[end]) && line[end] != ',' && line[end] != ';') {
      ++end;
    }
    if (end == at) refuse(input_, at_line() + " has an empty column: " + in_quotes(line));
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

std::vector<std::string> names_in(std::string_view line) {
  const char separator = line.find(',') != std::string_view::npos   ? ','
                         : line.find(';') != std::string_view::npos ? ';'
                                                                    : ' ';
  std::vector<std::string> names;
  while (!line.empty() && names.size() < kMostColumns) {
    std::string_view name;
    if (separator == ' ') {
      name = take_word(line);
      if (name.empty()) break;
    } else {
      const std::size_t end = std::min(line.find(separator), line.size());
      name = line.substr(0, end);
      line.remove_prefix(std::min(end + 1, line.size()));
      std::string_view rest = name;
      name = take_word(rest);  // "x [m]": the first word names it
    }
    if (parse_number(name)) return {};
    names.emplace_back(name);
  }
  return names;
}

std::optional<TextLayout> layout_by_names(std::span<const std::string> names) {
  TextLayout layout;
  layout.columns = names.size();
  const auto position = find_three(names, {Names{"x"}, Names{"y"}, Names{"z"}});
  if (!position) return std::nullopt;
  layout.position = *position;
  layout.normal = find_three(
      names, {Names{"nx", "normal_x"}, Names{"ny", "normal_y"}, Names{"nz", "normal_z"}});
  layout.colour = find_three(names, {Names{"r", "red"}, Names{"g", "green"}, Names{"b", "blue"}});
  return layout;
}

TextLayout layout_by_numbers(const Input& input) {
  constexpr std::size_t kLooked = 200;
  TextLayout layout;
  std::array<Evidence, 2> evidence;
  std::array<std::size_t, 2> first{3, 6};
  LineWindow lines(input);
  std::vector<std::string_view> words;
  std::string_view line;
  for (std::size_t seen = 0; seen < kLooked && lines.next(line);) {
    if (is_comment(line) || !names_in(line).empty()) continue;
    Splitter(input, lines).split(line, words);
    // A count or column names; or an error, which the reading itself will name.
    if (words.size() < 3 || !parse_number(words[0])) continue;
    if (layout.columns == 0) {
      layout.columns = words.size();
      // An odd column beside the threes is the intensity, and stands first (PTS).
      if (words.size() % 3 == 1) first = {4, 7};
    }
    if (words.size() < layout.columns) break;
    for (std::size_t group = 0; group < 2; ++group) {
      if (first[group] + 3 <= words.size()) weigh(words, first[group], evidence[group]);
    }
    ++seen;
  }
  for (std::size_t group = 0; group < 2; ++group) {
    if (first[group] + 3 > layout.columns) continue;
    const TextLayout::Three columns{first[group], first[group] + 1, first[group] + 2};
    if (evidence[group].could_be_normal) {
      layout.normal = columns;
    } else if (evidence[group].could_be_colour) {
      layout.colour = columns;
    }
  }
  return layout;
}

}  // namespace landmarkdb
