#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "engine/cloud/mesh.hpp"
#include "engine/cloud/read_mesh.hpp"
#include "engine/cloud/scalar.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kTitleBytes = 80;
constexpr std::size_t kHeaderBytes = kTitleBytes + 4;  // and the triangle count
constexpr std::size_t kTriangleBytes = 50;             // normal, three corners, attributes
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kCornerBytes = 12;

std::uint64_t triangle_count(const Input& input) {
  return static_cast<std::uint64_t>(
      load_scalar(input.bytes.data() + kTitleBytes, ScalarType::kUint32, false));
}

// A mesh may have more triangles than a cloud may have points: it is sampled.
void check_triangles(const Input& input, std::uint64_t triangles, const ReadOptions& options) {
  constexpr std::uint64_t kMostTriangles = std::numeric_limits<std::uint32_t>::max() / 3;
  const std::uint64_t most = std::min(options.max_points, kMostTriangles);
  if (triangles > most) {
    refuse(input, std::to_string(triangles) + " triangles, want at most " + std::to_string(most));
  }
}

void add_corner(Mesh& mesh, const Eigen::Vector3d& corner) {
  mesh.vertices.push_back(corner);
  const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
  if (count % 3 == 0) mesh.triangles.push_back({count - 3, count - 2, count - 1});
}

}  // namespace

bool is_binary_stl(const Input& input) {
  return input.bytes.size() > kHeaderBytes &&
         triangle_count(input) * kTriangleBytes + kHeaderBytes == input.size();
}

PointCloud parse_binary_stl(const Input& input, const ReadOptions& options) {
  if (input.bytes.size() < kHeaderBytes) {
    refuse(input,
           "an STL file of " + std::to_string(input.bytes.size()) + " bytes, want at least " +
               std::to_string(kHeaderBytes));
  }
  const std::uint64_t triangles = triangle_count(input);
  check_count(input,
              triangles,
              kTriangleBytes,
              input.bytes.size() - kHeaderBytes,
              std::numeric_limits<std::uint64_t>::max(),
              "triangles");
  check_triangles(input, triangles, options);
  Mesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(3 * triangles));
  mesh.triangles.reserve(static_cast<std::size_t>(triangles));
  const std::byte* at = input.bytes.data() + kHeaderBytes;
  for (std::uint64_t t = 0; t < triangles; ++t, at += kTriangleBytes) {
    input.tick(t, t * kTriangleBytes);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::byte* corner = at + kNormalBytes + k * kCornerBytes;
      add_corner(mesh,
                 {load_scalar(corner, ScalarType::kFloat32, false),
                  load_scalar(corner + 4, ScalarType::kFloat32, false),
                  load_scalar(corner + 8, ScalarType::kFloat32, false)});
    }
  }
  return sample_mesh(input, mesh, options);
}

PointCloud parse_ascii_stl(const Input& input, const ReadOptions& options) {
  Mesh mesh;
  LineReader lines(input.text());
  std::string_view line;
  bool ended = false;
  while (lines.next(line)) {
    input.tick(lines.number(), lines.at());
    std::string_view rest = line;
    const std::string_view keyword = take_word(rest);
    if (keyword == "endsolid") ended = true;
    if (keyword != "vertex") continue;
    Eigen::Vector3d corner;
    for (int axis = 0; axis < 3; ++axis) {
      const std::string_view word = take_word(rest);
      const std::optional<double> value = parse_number(word);
      if (!value) {
        refuse(input,
               "line " + std::to_string(lines.number()) + ": " + in_quotes(word) + " is no number");
      }
      corner[axis] = *value;
    }
    add_corner(mesh, corner);
    check_triangles(input, mesh.triangles.size(), options);
  }
  if (!ended || mesh.vertices.size() % 3 != 0) {
    refuse(input,
           "an STL file of " + std::to_string(mesh.vertices.size()) +
               " vertices that does not end in endsolid after whole triangles (truncated file?)");
  }
  return sample_mesh(input, mesh, options);
}

}  // namespace landmarkdb
