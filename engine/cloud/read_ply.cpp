#include "engine/cloud/read_ply.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "engine/cloud/byte_window.hpp"
#include "engine/cloud/cloud_builder.hpp"
#include "engine/cloud/mesh.hpp"
#include "engine/cloud/ply_header.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

// Gives the values of the body one after the other, whatever the format.
class BodyReader {
 public:
  BodyReader(const Input& input, const PlyHeader& header)
      : input_(input), format_(header.format), window_(input, header.body) {}

  double next(ScalarType type) {
    return format_ == PlyFormat::kAscii ? next_word() : next_binary(type);
  }

  void skip(ScalarType type, std::uint64_t count) {
    if (format_ == PlyFormat::kAscii) {
      for (std::uint64_t i = 0; i < count; ++i) next_word();
      return;
    }
    if (count > window_.left() / scalar_size(type)) refuse_end();
    window_.skip(count * scalar_size(type));
  }

  // How many items the list that starts here has; at most as many as the file can still hold.
  std::uint64_t next_count(const PlyProperty& list) {
    const double count = next(*list.count_type);
    const double left = static_cast<double>(window_.left());
    if (!(count >= 0.0 && count <= left && count == std::floor(count))) {
      refuse(input_,
             "PLY list " + in_quotes(list.name) + " of " + std::to_string(count) +
                 " items, want a count that fits into the file");
    }
    return static_cast<std::uint64_t>(count);
  }

  std::uint64_t at() const { return window_.at(); }

 private:
  [[noreturn]] void refuse_end() const {
    refuse(input_, "PLY data ends early: the header promises more (truncated file?)");
  }

  double next_binary(ScalarType type) {
    const std::span<const std::byte> bytes = window_.ahead(scalar_size(type));
    if (bytes.size() < scalar_size(type)) refuse_end();
    window_.skip(scalar_size(type));
    return load_scalar(bytes.data(), type, format_ == PlyFormat::kBigEndian);
  }

  double next_word() {
    const std::string_view word = take_word(window_);
    if (word.empty()) refuse_end();
    const std::optional<double> value = parse_number(word);
    if (!value) refuse(input_, "PLY data: " + in_quotes(word) + " is no number");
    return *value;
  }

  const Input& input_;
  PlyFormat format_;
  ByteWindow window_;
};

// Which column of a vertex means what; kNone where there is no such column.
struct Columns {
  std::array<std::size_t, 3> position{kNone, kNone, kNone};
  std::array<std::size_t, 3> normal{kNone, kNone, kNone};
  std::array<std::size_t, 3> colour{kNone, kNone, kNone};
  std::array<double, 3> colour_scale{1.0, 1.0, 1.0};  // to 0..255
  std::size_t viewpoint = kNone;
};

bool complete(const std::array<std::size_t, 3>& columns) {
  return std::find(columns.begin(), columns.end(), kNone) == columns.end();
}

double colour_scale(ScalarType type) {
  if (type == ScalarType::kFloat32 || type == ScalarType::kFloat64) return 255.0;
  return scalar_size(type) == 2 ? 255.0 / 65535.0 : 1.0;
}

Columns find_columns(const Input& input, const PlyElement& vertices) {
  static constexpr std::array<std::string_view, 3> kPosition{"x", "y", "z"};
  static constexpr std::array<std::string_view, 3> kNormal{"nx", "ny", "nz"};
  static constexpr std::array<std::string_view, 3> kColour{"red", "green", "blue"};
  static constexpr std::array<std::string_view, 3> kDiffuse{
      "diffuse_red", "diffuse_green", "diffuse_blue"};
  static constexpr std::array<std::string_view, 3> kShort{"r", "g", "b"};
  Columns columns;
  for (std::size_t i = 0; i < vertices.properties.size(); ++i) {
    const PlyProperty& property = vertices.properties[i];
    if (property.count_type) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (property.name == kPosition[axis]) columns.position[axis] = i;
      if (property.name == kNormal[axis]) columns.normal[axis] = i;
      if (property.name == kColour[axis] || property.name == kDiffuse[axis] ||
          property.name == kShort[axis]) {
        columns.colour[axis] = i;
        columns.colour_scale[axis] = colour_scale(property.type);
      }
    }
    if (property.name == "viewpoint") columns.viewpoint = i;
  }
  if (!complete(columns.position)) {
    refuse(input, "PLY header: the vertices have no x, y, z properties");
  }
  return columns;
}

// One vertex, a value a column; lists are skipped.
void read_row(BodyReader& body, const PlyElement& element, std::vector<double>& row) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.count_type) {
      body.skip(property.type, body.next_count(property));
    } else {
      row[i] = body.next(property.type);
    }
  }
}

Eigen::Vector3d take(const std::vector<double>& row, const std::array<std::size_t, 3>& columns) {
  return {row[columns[0]], row[columns[1]], row[columns[2]]};
}

std::array<std::uint8_t, 3> take_colour(const std::vector<double>& row, const Columns& columns) {
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = row[columns.colour[c]] * columns.colour_scale[c];
    colour[c] = value > 0.0 ? static_cast<std::uint8_t>(std::min(value + 0.5, 255.0)) : 0;
  }
  return colour;
}

void skip_element(const Input& input, BodyReader& body, const PlyElement& element) {
  std::vector<double> row(element.properties.size());
  for (std::uint64_t i = 0; i < element.count; ++i) {
    input.tick(i, body.at());
    read_row(body, element, row);
  }
}

std::uint16_t take_viewpoint(const Input& input, double value, std::size_t viewpoints) {
  if (!(value >= 0.0 && value < static_cast<double>(viewpoints))) {
    refuse(input,
           "PLY data: viewpoint number " + std::to_string(value) + ", but the header has " +
               std::to_string(viewpoints));
  }
  return static_cast<std::uint16_t>(value);
}

void read_points(const Input& input,
                 const PlyHeader& header,
                 const PlyElement& vertices,
                 BodyReader& body,
                 const ReadOptions& options,
                 const CloudSink& sink) {
  const Columns columns = find_columns(input, vertices);
  const bool normals = complete(columns.normal);
  const bool colours = complete(columns.colour);
  const bool numbered = columns.viewpoint != kNone && header.viewpoints.size() > 1;
  CloudBuilder builder(metres_per(options.units));
  builder.hand_to(sink, header.viewpoints);
  builder.reserve(vertices.count, normals, colours);
  std::vector<double> row(vertices.properties.size());
  for (std::uint64_t i = 0; i < vertices.count; ++i) {
    input.tick(i, body.at());
    read_row(body, vertices, row);
    builder.add_point(take(row, columns.position));
    if (normals) builder.add_normal(take(row, columns.normal));
    if (colours) builder.add_colour(take_colour(row, columns));
    if (numbered) {
      builder.add_viewpoint_index(
          take_viewpoint(input, row[columns.viewpoint], header.viewpoints.size()));
    }
  }
  sink.take(builder.finish());
}

void read_mesh_vertices(const Input& input,
                        const PlyElement& vertices,
                        BodyReader& body,
                        Mesh& mesh) {
  const Columns columns = find_columns(input, vertices);
  mesh.vertices.reserve(vertices.count);
  std::vector<double> row(vertices.properties.size());
  for (std::uint64_t i = 0; i < vertices.count; ++i) {
    input.tick(i, body.at());
    read_row(body, vertices, row);
    mesh.vertices.push_back(take(row, columns.position));
    if (complete(columns.normal)) {
      const Eigen::Vector3d n = take(row, columns.normal);
      mesh.normals.emplace_back(to_float(n.x()), to_float(n.y()), to_float(n.z()));
    }
    if (complete(columns.colour)) mesh.colours.push_back(take_colour(row, columns));
  }
}

bool is_corner_list(const PlyProperty& property) {
  return property.count_type &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

bool is_faces(const PlyElement& element) {
  return element.name == "face" && element.count > 0 &&
         std::any_of(element.properties.begin(), element.properties.end(), is_corner_list);
}

void read_faces(const Input& input,
                const PlyElement& faces,
                std::uint64_t vertex_count,
                BodyReader& body,
                Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < faces.count; ++i) {
    input.tick(i, body.at());
    for (const PlyProperty& property : faces.properties) {
      if (!is_corner_list(property)) {
        body.skip(property.type, property.count_type ? body.next_count(property) : 1);
        continue;
      }
      corners.clear();
      const std::uint64_t count = body.next_count(property);
      for (std::uint64_t k = 0; k < count; ++k) {
        const double corner = body.next(property.type);
        if (!(corner >= 0.0 && corner < static_cast<double>(vertex_count))) {
          refuse(input,
                 "PLY face " + std::to_string(i) + " names vertex " + std::to_string(corner) +
                     ", but there are " + std::to_string(vertex_count));
        }
        corners.push_back(static_cast<std::uint32_t>(corner));
      }
      add_polygon(mesh, corners);
    }
  }
}

}  // namespace

namespace {

using Elements = std::vector<PlyElement>;

Elements::const_iterator find_vertices(const Input& input, const PlyHeader& header) {
  const auto vertices =
      std::find_if(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
        return element.name == "vertex";
      });
  if (vertices == header.elements.end() || vertices->count == 0) {
    refuse(input, "PLY header: no vertices");
  }
  return vertices;
}

bool has_faces(const Input& input, const PlyHeader& header, const PlyElement& vertices) {
  const bool is_mesh = std::any_of(header.elements.begin(), header.elements.end(), is_faces);
  if (is_mesh && vertices.count > std::numeric_limits<std::uint32_t>::max()) {
    refuse(input, "a mesh of " + std::to_string(vertices.count) + " vertices, want below 2^32");
  }
  return is_mesh;
}

// All elements of a file that has faces.
void read_mesh(const Input& input,
               const PlyHeader& header,
               const PlyElement& vertices,
               Mesh& mesh) {
  BodyReader body(input, header);
  for (const PlyElement& element : header.elements) {
    if (&element == &vertices) {
      read_mesh_vertices(input, element, body, mesh);
    } else if (is_faces(element)) {
      read_faces(input, element, vertices.count, body, mesh);
    } else {
      skip_element(input, body, element);
    }
  }
}

}  // namespace

Mesh parse_ply_polygons(const Input& input, const ReadOptions& options) {
  const PlyHeader header = parse_ply_header(input, options.max_points);
  const auto vertices = find_vertices(input, header);
  Mesh mesh;
  mesh.keep_polygons = true;
  if (has_faces(input, header, *vertices)) read_mesh(input, header, *vertices, mesh);
  return mesh;
}

void parse_ply(const Input& input, const ReadOptions& options, const CloudSink& sink) {
  const PlyHeader header = parse_ply_header(input, options.max_points);
  const auto vertices = find_vertices(input, header);
  if (has_faces(input, header, *vertices)) {
    Mesh mesh;
    read_mesh(input, header, *vertices, mesh);
    return sink.take(sample_mesh(input, mesh, options));
  }
  BodyReader body(input, header);
  for (const PlyElement& element : header.elements) {
    // Nothing after the vertices matters where there are no faces.
    if (&element == &*vertices) return read_points(input, header, element, body, options, sink);
    skip_element(input, body, element);
  }
  refuse(input, "PLY header: no vertices");
}

}  // namespace landmarkdb
