#include "tests/unit/engine/cloud/cloud_files.hpp"

#include <algorithm>
#include <array>

namespace landmarkdb::testing {
namespace {

std::string number(double value) {
  std::string text = std::to_string(value);
  while (text.back() == '0') text.pop_back();
  return text.back() == '.' ? text + "0" : text;
}

std::string coordinates(int i) {
  const Eigen::Vector3f p = point(i);
  return number(p.x()) + " " + number(p.y()) + " " + number(p.z());
}

constexpr std::array<std::array<double, 3>, 4> kTetrahedron{
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr std::array<std::array<int, 3>, 4> kOutwardFaces{
    {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};

}  // namespace

std::string ply_ascii(int points) {
  std::string file = "ply\nformat ascii 1.0\ncomment a test\nelement vertex " +
                     std::to_string(points) +
                     "\nproperty uchar red\nproperty float x\nproperty float y\nproperty double z\n"
                     "property list uchar int tags\nproperty uchar green\nproperty uchar blue\n"
                     "property float nx\nproperty float ny\nproperty float nz\nend_header\n";
  for (int i = 0; i < points; ++i) {
    file += std::to_string(i % 256) + " " + coordinates(i) + " 2 7 8 20 30 0 0 1\n";
  }
  return file;
}

std::string ply_binary(int points, bool big_endian) {
  std::string file = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                     "_endian 1.0\nelement camera 1\nproperty list uchar float data\n"
                     "element vertex " +
                     std::to_string(points) +
                     "\nproperty float x\nproperty double y\nproperty float z\n"
                     "property list uchar short tags\nproperty uchar red\nproperty uchar green\n"
                     "property uchar blue\nend_header\n";
  put<std::uint8_t>(file, 2);
  put(file, 1.5F, big_endian);
  put(file, 2.5F, big_endian);
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3f p = point(i);
    put(file, p.x(), big_endian);
    put(file, static_cast<double>(p.y()), big_endian);
    put(file, p.z(), big_endian);
    put<std::uint8_t>(file, 1);
    put<std::int16_t>(file, -3, big_endian);
    put(file, static_cast<std::uint8_t>(i));
    put<std::uint8_t>(file, 20);
    put<std::uint8_t>(file, 30);
  }
  return file;
}

std::string ply_mesh_ascii() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n";
}

std::string pcd_ascii(int points) {
  std::string file =
      "# .PCD v.7 - Point Cloud Data file format\nVERSION .7\nFIELDS rgb x y z extra\n"
      "SIZE 4 4 4 8 2\nTYPE U F F F I\nCOUNT 1 1 1 1 2\nWIDTH " +
      std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
      std::to_string(points) + "\nDATA ascii\n";
  for (int i = 0; i < points; ++i) file += "660510 " + coordinates(i) + " -1 2\n";
  return file;
}

std::string pcd_binary(int points) {
  std::string file =
      "VERSION 0.7\nFIELDS x _ y z normal_x normal_y normal_z\nSIZE 4 1 8 4 4 4 4\n"
      "TYPE F U F F F F F\nCOUNT 1 3 1 1 1 1 1\nWIDTH " +
      std::to_string(points) + "\nHEIGHT 1\nVIEWPOINT 1 2 3 0.70710678118654752 0 0 " +
      "0.70710678118654752\nPOINTS " + std::to_string(points) + "\nDATA binary\n";
  for (int i = 0; i < points; ++i) {
    const Eigen::Vector3f p = point(i);
    put(file, p.x());
    file += "abc";
    put(file, static_cast<double>(p.y()));
    put(file, p.z());
    put(file, 1.0F);
    put(file, 0.0F);
    put(file, 0.0F);
  }
  return file;
}

std::string lzf_literals(std::string_view plain) {
  constexpr std::size_t kMost = 32;
  std::string packed;
  for (std::size_t at = 0; at < plain.size(); at += kMost) {
    const std::string_view piece = plain.substr(at, kMost);
    packed += static_cast<char>(piece.size() - 1);
    packed += piece;
  }
  return packed;
}

std::string pcd_compressed(int points) {
  std::string file =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
      std::to_string(points / 2) + "\nHEIGHT 2\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
      std::to_string(points) + "\nDATA binary_compressed\n";
  std::string plain;
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < points; ++i) put(plain, point(i)[axis]);
  }
  const std::string packed = lzf_literals(plain);
  put(file, static_cast<std::uint32_t>(packed.size()));
  put(file, static_cast<std::uint32_t>(plain.size()));
  return file + packed;
}

std::string xyz_text(int points) {
  std::string file = "# a comment\n// another\n\n";
  for (int i = 0; i < points; ++i) file += coordinates(i) + "\n";
  return file;
}

std::string pts_text(int points) {
  std::string file = std::to_string(points) + "\n";
  for (int i = 0; i < points; ++i) file += coordinates(i) + " -1024 10 20 30\n";
  return file;
}

std::string obj_cube() {
  std::string file = "# a cube\no cube\nmtllib none.mtl\n";
  for (int i = 0; i < 8; ++i) {
    file += "v " + std::to_string(i & 1) + " " + std::to_string((i >> 1) & 1) + " " +
            std::to_string((i >> 2) & 1) + "\n";
  }
  return file +
         "vn 0 0 1\nf 1//1 3//1 4//1 2//1\nf 5/1/1 6 8 7\nf 1 2 6 5\nf 3 7 8 \\\n 4\n"
         "f -8 -4 -2 -6\nf 2 4 8 6\n";
}

std::string stl_ascii() {
  std::string file = "solid tetrahedron\n";
  for (const auto& face : kOutwardFaces) {
    file += "facet normal 0 0 0\nouter loop\n";
    for (const int corner : face) {
      const auto& p = kTetrahedron[static_cast<std::size_t>(corner)];
      file += "vertex " + number(p[0]) + " " + number(p[1]) + " " + number(p[2]) + "\n";
    }
    file += "endloop\nendfacet\n";
  }
  return file + "endsolid tetrahedron\n";
}

std::string stl_binary() {
  std::string file = "solid, says this title of a binary file";
  file.resize(80, ' ');
  put(file, static_cast<std::uint32_t>(kOutwardFaces.size()));
  for (const auto& face : kOutwardFaces) {
    for (int k = 0; k < 3; ++k) put(file, 0.0F);
    for (const int corner : face) {
      for (const double value : kTetrahedron[static_cast<std::size_t>(corner)]) {
        put(file, static_cast<float>(value));
      }
    }
    put<std::uint16_t>(file, 0);
  }
  return file;
}

std::vector<NamedFile> one_of_each() {
  constexpr int kPoints = 20;
  return {{"a.ply", ply_ascii(kPoints)},
          {"b.ply", ply_binary(kPoints, false)},
          {"c.ply", ply_binary(kPoints, true)},
          {"d.ply", ply_mesh_ascii()},
          {"a.pcd", pcd_ascii(kPoints)},
          {"b.pcd", pcd_binary(kPoints)},
          {"c.pcd", pcd_compressed(kPoints)},
          {"a.xyz", xyz_text(kPoints)},
          {"a.pts", pts_text(kPoints)},
          {"a.obj", obj_cube()},
          {"a.stl", stl_ascii()},
          {"b.stl", stl_binary()}};
}

}  // namespace landmarkdb::testing
