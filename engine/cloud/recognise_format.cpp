#include "engine/cloud/recognise_format.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "engine/cloud/read_mesh.hpp"
#include "engine/cloud/text_lines.hpp"

namespace landmarkdb {
namespace {

using namespace std::string_view_literals;

struct Foreign {
  std::string_view magic;
  std::string_view what;
};

constexpr std::string_view kConvert = "; convert it to PLY or PCD first";

// Files that people do hand in, by their first bytes.
constexpr std::array<Foreign, 16> kForeign{{
    {"LASF"sv, "a LAS or LAZ scan"},
    {"ASTM-E57"sv, "an E57 scan"},
    {"\x89PNG"sv, "a PNG image (a depth image needs a camera file with it)"},
    {"\xff\xd8\xff"sv, "a JPEG image"},
    {"SQLite format 3"sv, "a SQLite database"},
    {"#ROSBAG"sv, "a ROS bag"},
    {"\x89MCAP"sv, "an MCAP recording"},
    {"glTF"sv, "a binary glTF model"},
    {"PK\x03\x04"sv, "a zip archive (3MF and others)"},
    {"\x1f\x8b"sv, "a gzip archive"},
    {"\x28\xb5\x2f\xfd"sv, "a zstd archive"},
    {"7z\xbc\xaf"sv, "a 7z archive"},
    {"Kaydara FBX"sv, "an FBX model"},
    {"\x93NUMPY"sv, "a NumPy array"},
    {"\x89HDF"sv, "an HDF5 file"},
    {"OFF"sv, "an OFF model"},
}};

std::string lower_extension(std::string_view name) {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string_view::npos || name.find('/', dot) != std::string_view::npos) return {};
  std::string extension(name.substr(dot));
  constexpr std::size_t kLongest = 16;
  extension.resize(std::min(extension.size(), kLongest));
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return extension;
}

bool looks_like_text(std::string_view text) {
  constexpr std::size_t kLooked = 4096;
  return std::all_of(text.begin(),
                     text.begin() + static_cast<std::ptrdiff_t>(std::min(text.size(), kLooked)),
                     [](char c) {
                       return static_cast<unsigned char>(c) >= 0x80 || (c >= ' ' && c <= '~') ||
                              is_blank(c);
                     });
}

// The first word that is not in a comment.
std::string_view first_word(std::string_view text) {
  LineReader lines(text);
  std::string_view line;
  while (lines.next(line)) {
    const std::string_view word = take_word(line);
    if (!word.empty() && word.front() != '#') return word;
  }
  return {};
}

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

CloudFormat recognise_format(const Input& input) {
  const std::string_view text = input.text();
  if (text.empty()) refuse(input, "is empty, want a point cloud or a mesh");
  const std::string extension = lower_extension(input.name);
  if (text.starts_with("ply") && text.size() > 3 && is_blank(text[3])) return CloudFormat::kPly;
  for (const Foreign& foreign : kForeign) {
    if (text.starts_with(foreign.magic)) {
      refuse(input, "is " + std::string(foreign.what) + std::string(kConvert));
    }
  }
  if (is_binary_stl(input)) return CloudFormat::kBinaryStl;
  // A PCD file may start with its comment or with any of the header's first lines.
  const std::string_view word = first_word(text);
  if (is_one_of(word, {"VERSION", "FIELDS", "COLUMNS"}) || text.starts_with("# .PCD")) {
    return CloudFormat::kPcd;
  }
  if (!looks_like_text(text)) {
    if (extension == ".stl") return CloudFormat::kBinaryStl;
    refuse(input,
           "is in no format that can be read; want PCD, PLY, XYZ or PTS text, or an OBJ, STL or "
           "PLY mesh");
  }
  if (word == "solid" && text.find("facet") != std::string_view::npos) {
    return CloudFormat::kAsciiStl;
  }
  const bool obj_word =
      is_one_of(word, {"v", "vn", "vt", "vp", "f", "o", "g", "s", "mtllib", "usemtl", "l", "p"});
  if (obj_word || extension == ".obj") return CloudFormat::kObj;
  if (extension == ".ptx") refuse(input, "is a PTX scan" + std::string(kConvert));
  if (extension == ".ply" || extension == ".pcd" || extension == ".stl") {
    refuse(input, "starts with " + in_quotes(text) + ", which no " + extension + " file does");
  }
  return CloudFormat::kText;
}

}  // namespace landmarkdb
