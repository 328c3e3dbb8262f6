#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/mesh.hpp"
#include "engine/cloud/read_mesh.hpp"
#include "engine/cloud/read_ply.hpp"
#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

class ObjReader {
 public:
  ObjReader(const Input& input, const ReadOptions& options, bool keep_polygons = false)
      : input_(input), options_(options), lines_(input.text()) {
    mesh_.keep_polygons = keep_polygons;
  }

  Mesh read() {
    std::string joined;
    std::string_view line;
    while (lines_.next(line)) {
      input_.tick(lines_.number(), lines_.at());
      if (!line.empty() && line.back() == '\\') line = join(line, joined);
      std::string_view rest = line.substr(0, line.find('#'));
      const std::string_view keyword = take_word(rest);
      if (keyword == "v") {
        add_vertex(rest);
      } else if (keyword == "f" || keyword == "fo") {
        add_face(rest);
      }
    }
    if (mesh_.colours.size() != mesh_.vertices.size()) mesh_.colours.clear();
    return std::move(mesh_);
  }

 private:
  std::string where() const { return "line " + std::to_string(lines_.number()); }

  // A line that ends in a backslash goes on in the next one.
  std::string_view join(std::string_view line, std::string& joined) {
    joined.clear();
    for (;;) {
      const bool goes_on = !line.empty() && line.back() == '\\';
      joined.append(goes_on ? line.substr(0, line.size() - 1) : line);
      joined += ' ';
      if (!goes_on || !lines_.next(line)) return joined;
    }
  }

  void add_vertex(std::string_view rest) {
    if (mesh_.vertices.size() >= std::min<std::uint64_t>(options_.max_points, kMostVertices)) {
      refuse(input_, "more than " + std::to_string(mesh_.vertices.size()) + " vertices");
    }
    std::array<double, 6> values{};
    std::size_t count = 0;
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      const std::optional<double> value = parse_number(word);
      if (!value) refuse(input_, where() + ": " + in_quotes(word) + " is no number");
      if (count < values.size()) values[count] = *value;
      ++count;
    }
    if (count < 3) {
      refuse(input_, where() + ": a vertex of " + std::to_string(count) + " numbers, want 3");
    }
    mesh_.vertices.emplace_back(values[0], values[1], values[2]);
    if (count == 6 && mesh_.colours.size() + 1 == mesh_.vertices.size()) {
      mesh_.colours.push_back(to_colour(values));
    }
  }

  // Vertex colours are 0..1 in most files and 0..255 in some.
  static std::array<std::uint8_t, 3> to_colour(const std::array<double, 6>& values) {
    const double scale = std::max({values[3], values[4], values[5]}) <= 1.0 ? 255.0 : 1.0;
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c) {
      const double value = values[3 + c] * scale;
      colour[c] = value > 0.0 ? static_cast<std::uint8_t>(std::min(value + 0.5, 255.0)) : 0;
    }
    return colour;
  }

  void add_face(std::string_view rest) {
    corners_.clear();
    for (std::string_view word = take_word(rest); !word.empty(); word = take_word(rest)) {
      corners_.push_back(corner(word.substr(0, word.find('/'))));
    }
    if (corners_.size() < 3) {
      refuse(input_,
             where() + ": a face of " + std::to_string(corners_.size()) + " corners, want 3");
    }
    add_polygon(mesh_, corners_);
  }

  // 1 is the first vertex, -1 the last one so far.
  std::uint32_t corner(std::string_view word) const {
    const std::size_t count = mesh_.vertices.size();
    const bool from_end = word.starts_with('-');
    const std::optional<std::uint64_t> number = parse_count(from_end ? word.substr(1) : word);
    if (!number || *number == 0 || *number > count) {
      refuse(input_,
             where() + ": vertex " + in_quotes(word) + ", but there are " + std::to_string(count) +
                 " before it");
    }
    return static_cast<std::uint32_t>(from_end ? count - *number : *number - 1);
  }

  static constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

  const Input& input_;
  const ReadOptions& options_;
  LineReader lines_;
  Mesh mesh_;
  std::vector<std::uint32_t> corners_;
};

}  // namespace

Mesh parse_polygons(const Input& input, std::uint64_t max_vertices) {
  const ReadOptions options{.max_points = max_vertices};
  if (input.text().starts_with("ply")) return parse_ply_polygons(input, options);
  return ObjReader(input, options, true).read();
}

PointCloud parse_obj(const Input& input, const ReadOptions& options) {
  const Mesh mesh = ObjReader(input, options).read();
  if (mesh.vertices.empty()) refuse(input, "an OBJ file without vertices");
  if (!mesh.triangles.empty()) return sample_mesh(input, mesh, options);
  CloudBuilder builder(metres_per(options.units));
  for (const Eigen::Vector3d& vertex : mesh.vertices) builder.add_point(vertex);
  for (const auto& colour : mesh.colours) builder.add_colour(colour);
  return builder.finish();
}

}  // namespace landmarkdb
