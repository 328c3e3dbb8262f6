#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/read_cloud.hpp"

// Small valid files of every format, built byte by byte: the tests' own idea of the formats.
namespace landmarkdb::testing {

inline std::span<const std::byte> as_bytes(std::string_view text) {
  return std::as_bytes(std::span<const char>(text.data(), text.size()));
}

inline PointCloud parse(std::string_view file,
                        std::string_view name = "file",
                        const ReadOptions& options = {}) {
  return parse_cloud(as_bytes(file), name, options);
}

template <typename T>
void put(std::string& out, T value, bool big_endian = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
  if (big_endian) bytes = std::string(bytes.rbegin(), bytes.rend());
  out += bytes;
}

// Point i of all the files: (i, 2 i, -i) / 4, exact in float.
inline Eigen::Vector3f point(int i) {
  const auto x = static_cast<float>(i);
  return {0.25F * x, 0.5F * x, -0.25F * x};
}

std::string ply_ascii(int points);
std::string ply_binary(int points, bool big_endian);
std::string ply_mesh_ascii();
std::string pcd_ascii(int points);
std::string pcd_binary(int points);
std::string pcd_compressed(int points);
std::string xyz_text(int points);
std::string pts_text(int points);
std::string obj_cube();
std::string stl_ascii();
std::string stl_binary();

// LZF data of `plain` as literals only; valid, though not shorter.
std::string lzf_literals(std::string_view plain);

// Every one of the files above with a name.
struct NamedFile {
  std::string name;
  std::string bytes;
};
std::vector<NamedFile> one_of_each();

}  // namespace landmarkdb::testing
