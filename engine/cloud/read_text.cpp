#include "engine/cloud/read_text.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/cloud/byte_window.hpp"
#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_columns.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kLeastLineBytes = 6;  // "0 0 0" and a line end

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
      if (!std::exchange(started_, true)) {
        names_ = names_in(line);  // or a title
        if (!names_.empty()) continue;
      }
      splitter.split(line, words);
      if (words.size() == 1 && start_block(words[0])) continue;
      if (layout_.columns == 0) layout_ = layout_for(words);
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
  std::string at_line() const { return "line " + std::to_string(lines_.number()); }

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

  // By the names, where there is one for each column of the first row at the most. A name for each
  // that does not say which are x, y and z is no title: taking the first three would put an
  // identifier for x.
  TextLayout layout_for(const std::vector<std::string_view>& row) const {
    const std::optional<TextLayout> named = layout_by_names(names_);
    if (named && names_.size() <= row.size()) return without_odd_colours(*named, row);
    if (names_.size() >= 3 && names_.size() == row.size()) {
      std::string listed;
      for (const std::string& name : names_) listed += (listed.empty() ? "" : ", ") + name;
      refuse(input_,
             "names its columns " + in_quotes(listed) +
                 ", want x, y and z among them (or no names, and these three first)");
    }
    return layout_by_numbers(input_);
  }

  // Colours count to 255; shares of one would all be black.
  static TextLayout without_odd_colours(TextLayout layout,
                                        const std::vector<std::string_view>& row) {
    if (!layout.colour) return layout;
    for (const std::size_t column : *layout.colour) {
      const std::optional<std::uint64_t> value = parse_count(row[column]);
      if (!value || *value > 255) layout.colour.reset();
      if (!layout.colour) break;
    }
    return layout;
  }

  Eigen::Vector3d numbers(const std::vector<std::string_view>& words,
                          const TextLayout::Three& columns) const {
    Eigen::Vector3d values;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<double> value = parse_number(words[columns[k]]);
      if (!value) {
        refuse(input_, at_line() + ": " + in_quotes(words[columns[k]]) + " is no number");
      }
      values[static_cast<Eigen::Index>(k)] = *value;
    }
    return values;
  }

  void add(const std::vector<std::string_view>& words, std::string_view line) {
    if (words.size() < std::max<std::size_t>(3, layout_.columns)) {
      refuse(input_,
             at_line() + " has " + std::to_string(words.size()) + " columns, want " +
                 std::to_string(std::max<std::size_t>(3, layout_.columns)) + ": " +
                 in_quotes(line));
    }
    if (promised_ && builder_.size() == due_) {
      refuse(input_, at_line() + ": more points than the " + std::to_string(due_) + " promised");
    }
    if (builder_.size() >= options_.max_points) {
      refuse(input_, "more than " + std::to_string(options_.max_points) + " points");
    }
    builder_.add_point(numbers(words, layout_.position));
    if (layout_.normal) builder_.add_normal(numbers(words, *layout_.normal));
    if (layout_.colour) {
      const Eigen::Vector3d rgb = numbers(words, *layout_.colour);
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
  TextLayout layout_;
  std::vector<std::string> names_;  // of the first line, where it had no numbers
  bool started_ = false;
  bool promised_ = false;
  std::uint64_t due_ = 0;  // points after the block that is being read
};

}  // namespace

void parse_text_cloud(const Input& input, const ReadOptions& options, const CloudSink& sink) {
  TextCloudReader(input, options, sink).read();
}

}  // namespace landmarkdb
