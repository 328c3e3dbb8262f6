#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/byte_window.hpp"
#include "engine/cloud/input.hpp"

namespace landmarkdb {

// Whether a line of a text cloud holds nothing, or what is no point ("#" or "//" first).
bool is_comment(std::string_view line);

// Splits a line into words; a separator may have blanks around it. Refuses a line with two kinds:
// "1,5 2,5" would silently become four numbers where two with a decimal comma are meant.
class Splitter {
 public:
  // Both must outlive it; `lines` is where errors are.
  Splitter(const Input& input, const LineWindow& lines) : input_(input), lines_(lines) {}

  // Throws Error{kInvalidArgument} that names the line.
  void split(std::string_view line, std::vector<std::string_view>& words) const;

 private:
  const Input& input_;
  const LineWindow& lines_;
};

// Which columns a point's numbers stand in.
struct TextLayout {
  using Three = std::array<std::size_t, 3>;

  std::size_t columns = 0;  // that a line has at the least
  Three position{0, 1, 2};
  std::optional<Three> normal, colour;
};

// The names in a line of them, without what parts them (commas or semicolons, or else blanks);
// nothing where a number is among them.
std::vector<std::string> names_in(std::string_view line);

// By the names of the columns, in any order and case: x y z; nx ny nz or normal_x ..; r g b or
// red ..; a unit may follow in brackets. Nothing where x, y and z are not among them.
std::optional<TextLayout> layout_by_names(std::span<const std::string> names);

// By the first lines of numbers: x y z [intensity] [three] [three], where three numbers are a
// colour or a normal if all that are looked at could be.
TextLayout layout_by_numbers(const Input& input);

}  // namespace landmarkdb
