#include "engine/cloud/read_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/byte_window.hpp"
#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMostColumns = 64;    // those beyond are not looked at
constexpr std::size_t kLeastLineBytes = 6;  // "0 0 0" and a line end

std::string at_line(const LineWindow& lines) { return "line " + std::to_string(lines.number()); }

bool is_comment(std::string_view line) {
  std::string_view rest = line;
  const std::string_view word = take_word(rest);
  return word.empty() || word.front() == '#' || word.starts_with("//");
}

// Splits a line into words; a separator may have blanks around it. Refuses a line with two kinds:
// "1,5 2,5" would silently become four numbers where two with a decimal comma are meant.
class Splitter {
 public:
  Splitter(const Input& input, const LineWindow& lines) : input_(input), lines_(lines) {}

  void split(std::string_view line, std::vector<std::string_view>& words) const {
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
                 at_line(lines_) + " has two kinds of separators: " + in_quotes(line) +
                     " (decimal commas are not supported)");
        }
      }
      std::size_t end = at;
      while (end < line.size() && !is_blank(line[end]) && line[end] != ',' && line[end] != ';') {
        ++end;
      }
      if (end == at) {
        refuse(input_, at_line(lines_) + " has an empty column: " + in_quotes(line));
      }
      words.push_back(line.substr(at, end - at));
      at = end;
    }
  }

 private:
  // Moves `at` to the next word; returns ',' or ';' or, without either, ' '.
  static char skip_separator(std::string_view line, std::size_t& at) {
    char found = ' ';
    for (; at < line.size(); ++at) {
      const char c = line[at];
      if (is_blank(c)) continue;
      if ((c != ',' && c != ';') || found != ' ') break;
      found = c;
    }
    return found;
  }

  const Input& input_;
  const LineWindow& lines_;
};

// What stands in columns `first`, first + 1, first + 2.
struct Layout {
  std::size_t columns = 0;
  std::size_t colour = 0, normal = 0;  // 0: none
};

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

// Decides the columns from the first lines. x y z [intensity] [three] [three].
Layout find_layout(const Input& input) {
  constexpr std::size_t kLooked = 200;
  Layout layout;
  std::array<Evidence, 2> evidence;
  std::array<std::size_t, 2> first{3, 6};
  LineWindow lines(input);
  std::vector<std::string_view> words;
  std::string_view line;
  for (std::size_t seen = 0; seen < kLooked && lines.next(line);) {
    if (is_comment(line)) continue;
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
    if (evidence[group].could_be_normal) {
      layout.normal = first[group];
    } else if (evidence[group].could_be_colour) {
      layout.colour = first[group];
    }
  }
  return layout;
}

class TextCloudReader {
 public:
  TextCloudReader(const Input& input, const ReadOptions& options, const CloudSink& sink)
      : input_(input),
        options_(options),
        sink_(sink),
        lines_(input),
        builder_(metres_per(options.units)) {
    builder_.hand_to(sink_, {});
  }

  void read() {
    std::vector<std::string_view> words;
    std::string_view line;
    const Splitter splitter(input_, lines_);
    while (lines_.next(line)) {
      input_.tick(lines_.number(), lines_.at());
      if (is_comment(line)) continue;
      splitter.split(line, words);
      if (words.size() == 1 && start_block(words[0])) continue;
      if (builder_.size() == 0 && !started_) {
        started_ = true;
        if (is_column_names(words)) continue;
      }
      if (layout_.columns == 0) layout_ = find_layout(input_);
      add(words, line);
    }
    if (promised_ && builder_.size() < due_) {
      refuse(input_,
             "promises " + std::to_string(due_) + " points, but has " +
                 std::to_string(builder_.size()) + " (truncated file?)");
    }
    if (builder_.size() == 0) refuse(input_, "text without any points");
    sink_.take(builder_.finish());
  }

 private:
  // A count line. True when it was one.
  bool start_block(std::string_view word) {
    const std::optional<std::uint64_t> count = parse_count(word);
    if (!count || builder_.size() < due_ || (!promised_ && builder_.size() > 0)) return false;
    const std::uint64_t left = input_.size() - lines_.at() + 1;
    const std::uint64_t room =
        options_.max_points - std::min<std::uint64_t>(options_.max_points, builder_.size());
    check_count(input_, *count, kLeastLineBytes, left, room, "points");
    promised_ = true;
    due_ = builder_.size() + *count;
    return true;
  }

  static bool is_column_names(const std::vector<std::string_view>& words) {
    return std::none_of(words.begin(), words.end(), [](std::string_view word) {
      return parse_number(word).has_value();
    });
  }

  Eigen::Vector3d numbers(const std::vector<std::string_view>& words, std::size_t first) const {
    Eigen::Vector3d values;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<double> value = parse_number(words[first + k]);
      if (!value) {
        refuse(input_, at_line(lines_) + ": " + in_quotes(words[first + k]) + " is no number");
      }
      values[static_cast<Eigen::Index>(k)] = *value;
    }
    return values;
  }

  void add(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.size() < std::max<std::size_t>(3, layout_.columns)) {
      refuse(input_,
             at_line(lines_) + " has " + std::to_string(words.size()) + " columns, want " +
                 std::to_string(std::max<std::size_t>(3, layout_.columns)) + ": " +
                 in_quotes(line));
    }
    if (promised_ && builder_.size() == due_) {
      refuse(input_,
             at_line(lines_) + ": more points than the " + std::to_string(due_) + " promised");
    }
    if (builder_.size() >= options_.max_points) {
      refuse(input_, "more than " + std::to_string(options_.max_points) + " points");
    }
    builder_.add_point(numbers(words, 0));
    if (layout_.normal != 0) builder_.add_normal(numbers(words, layout_.normal));
    if (layout_.colour != 0) {
      const Eigen::Vector3d rgb = numbers(words, layout_.colour);
      std::array<std::uint8_t, 3> colour{};
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = rgb[static_cast<Eigen::Index>(c)];
        colour[c] = value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : 0;
      }
      builder_.add_colour(colour);
    }
  }

  const Input& input_;
  const ReadOptions& options_;
  const CloudSink& sink_;
  LineWindow lines_;
  CloudBuilder builder_;
  Layout layout_;
  bool started_ = false;
  bool promised_ = false;
  std::uint64_t due_ = 0;  // points after the block that is being read
};

}  // namespace

void parse_text_cloud(const Input& input, const ReadOptions& options, const CloudSink& sink) {
  TextCloudReader(input, options, sink).read();
}

}  // namespace landmarkdb
