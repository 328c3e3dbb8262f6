#include "store/scene_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"
#include "store/names.hpp"
#include "store/sha256.hpp"
#include "store/utf8.hpp"

namespace landmarkdb {
namespace {

using Json = nlohmann::json;

constexpr std::string_view kMagic{"LMDKSCN\n", 8};
constexpr std::uint32_t kLayout = 1;
constexpr std::size_t kPrefixBytes = 8 + 3 * sizeof(std::uint32_t);
constexpr std::size_t kDigestBytes = 64;  // hexadecimal
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20U;
constexpr std::size_t kPieceBytes = std::size_t{4} << 20U;  // between looks at the stop request

void append_number(std::string& bytes, std::uint32_t value) {
  for (unsigned shift = 0; shift < 32; shift += 8) {
    bytes += static_cast<char>((value >> shift) & 0xffU);
  }
}

std::uint32_t number_at(const std::string& bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (unsigned i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  }
  return value;
}

std::string header_json(const SceneFile& file) {
  Json landmarks = Json::array();
  for (const Landmark& l : file.extras.landmarks) {
    landmarks.push_back({{"name", l.name},
                         {"min_m", {l.min_m.x(), l.min_m.y(), l.min_m.z()}},
                         {"max_m", {l.max_m.x(), l.max_m.y(), l.max_m.z()}}});
  }
  const Json json = {{"name", file.name},
                     {"tags", file.extras.tags},
                     {"landmarks", std::move(landmarks)},
                     {"segment_sha256", file.segment.sha256}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

// A file of known size, read from the front; asking for more than is left is an Error.
class BoundedReader {
 public:
  BoundedReader(const std::string& path, const RunContext& context)
      : path_(path), context_(context) {
    namespace fs = std::filesystem;
    std::error_code error;
    if (path.empty() || path.find('\0') != std::string::npos || !fs::is_regular_file(path, error)) {
      fail(error ? error.message() : "there is no such file");
    }
    size_ = left_ = fs::file_size(path, error);
    if (error) fail(error.message());
    file_.open(path, std::ios::binary);
    if (!file_) {
      throw Error(ErrorCode::kPermissionDenied, "'" + path + "': " + std::strerror(errno));
    }
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kInvalidArgument, "'" + path_ + "' cannot be imported: " + why);
  }
  std::uint64_t left() const { return left_; }

  template <typename Buffer>
  Buffer take(std::uint64_t count) {
    if (count > left_) {
      fail("it is cut off: " + std::to_string(left_) + " bytes left, want " +
           std::to_string(count));
    }
    Buffer buffer(count, typename Buffer::value_type{});
    for (std::size_t begin = 0; begin < buffer.size(); begin += kPieceBytes) {
      context_.report("import", size_ - left_, size_);
      const std::size_t piece = std::min(kPieceBytes, buffer.size() - begin);
      file_.read(reinterpret_cast<char*>(buffer.data()) + begin,
                 static_cast<std::streamsize>(piece));
      if (static_cast<std::size_t>(file_.gcount()) != piece) fail("reading it failed");
      left_ -= piece;
    }
    return buffer;
  }

 private:
  std::string path_;
  const RunContext& context_;
  std::ifstream file_;
  std::uint64_t size_ = 0;
  std::uint64_t left_ = 0;
};

Eigen::Vector3d read_vector(const Json& json) {
  const auto numbers = json.get<std::array<double, 3>>();
  return {numbers[0], numbers[1], numbers[2]};
}

// Fills all but the arrays; returns the digest that the manifest must have.
std::string read_header(const std::string& text, SceneFile& file) {
  const Json json = Json::parse(text);
  file.name = json.at("name").get<std::string>();
  validate_name(file.name, "scene name");
  file.extras.tags = json.at("tags").get<std::map<std::string, std::string>>();
  for (const Json& item : json.at("landmarks")) {
    file.extras.landmarks.push_back({item.at("name").get<std::string>(),
                                     read_vector(item.at("min_m")),
                                     read_vector(item.at("max_m"))});
  }
  for (const auto& [key, value] : file.extras.tags) {
    validate_name(key, "tag key");
    validate_tag_value(value);
  }
  for (const Landmark& landmark : file.extras.landmarks) validate_landmark(landmark);
  return json.at("segment_sha256").get<std::string>();
}

// The bytes up to the manifest, verified; returns the manifest's length and sets `digest`.
std::uint32_t read_front(BoundedReader& reader, SceneFile& file, std::string& digest) {
  std::string front =
      reader.take<std::string>(std::min<std::uint64_t>(kPrefixBytes, reader.left()));
  if (!front.starts_with(kMagic)) reader.fail("it is no landmarkdb scene file");
  if (front.size() < kPrefixBytes) reader.fail("it is cut off in its first bytes");
  const std::uint32_t layout = number_at(front, kMagic.size());
  if (layout != kLayout) {
    throw Error(ErrorCode::kUnimplemented,
                "a scene file of layout " + std::to_string(layout) + "; this program reads " +
                    std::to_string(kLayout));
  }
  const std::uint32_t header_bytes = number_at(front, kMagic.size() + 4);
  const std::uint32_t manifest_bytes = number_at(front, kMagic.size() + 8);
  if (header_bytes > kMaxHeaderBytes || manifest_bytes > kMaxManifestBytes) {
    reader.fail("its header or manifest has more than 1 MiB");
  }
  const auto header = reader.take<std::string>(header_bytes);
  if (reader.take<std::string>(kDigestBytes) != sha256_of(front + header)) {
    reader.fail("its header is damaged: the digest does not fit");
  }
  digest = read_header(header, file);
  return manifest_bytes;
}

void read_segment_bytes(BoundedReader& reader,
                        std::uint32_t manifest_bytes,
                        const std::string& digest,
                        SceneFile& file) {
  Segment& segment = file.segment;
  const std::string what = "scene '" + file.name + "'";
  segment.manifest_json = reader.take<std::string>(manifest_bytes);
  segment.sha256 = sha256_of(segment.manifest_json);
  if (segment.sha256 != digest) reader.fail("its manifest is damaged: the digest does not fit");
  segment.manifest = manifest_from_json(segment.manifest_json, what);
  for (const ArrayInfo& info : segment.manifest.arrays) {
    segment.arrays.push_back(reader.take<std::vector<std::byte>>(info.bytes));
    verify_array(info, segment.arrays.back(), what);
  }
  if (reader.left() != 0) {
    reader.fail(std::to_string(reader.left()) + " bytes follow its end");
  }
  decode_segment(segment, file.name, what);  // a lying file must not reach the database
}

}  // namespace

void write_scene_file(const std::string& path, const SceneFile& file, const RunContext& context) {
  const std::string header = header_json(file);
  if (header.size() > kMaxHeaderBytes) {
    throw Error(ErrorCode::kInvalidArgument,
                "the tags and landmarks of scene '" + file.name + "' take " +
                    std::to_string(header.size()) + " bytes, want at most 1 MiB");
  }
  std::string front(kMagic);
  append_number(front, kLayout);
  append_number(front, static_cast<std::uint32_t>(header.size()));
  append_number(front, static_cast<std::uint32_t>(file.segment.manifest_json.size()));
  front += header;
  front += sha256_of(front);
  front += file.segment.manifest_json;

  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream.write(front.data(), static_cast<std::streamsize>(front.size()));
  const std::uint64_t total = file.segment.bytes();
  std::uint64_t done = 0;
  for (const std::vector<std::byte>& array : file.segment.arrays) {
    for (std::size_t begin = 0; begin < array.size() && stream; begin += kPieceBytes) {
      context.report("export", done, total);
      const std::size_t piece = std::min(kPieceBytes, array.size() - begin);
      stream.write(reinterpret_cast<const char*>(array.data()) + begin,
                   static_cast<std::streamsize>(piece));
      done += piece;
    }
  }
  stream.close();
  if (!stream) {
    const int error = errno;
    throw Error(error == ENOSPC || error == EDQUOT || error == EFBIG ? ErrorCode::kResourceExhausted
                                                                     : ErrorCode::kPermissionDenied,
                "'" + path + "' cannot be written: " + std::strerror(error));
  }
  context.report("export", total, total);
}

SceneFile read_scene_file(const std::string& path, const RunContext& context) {
  BoundedReader reader(path, context);
  SceneFile file;
  try {
    std::string digest;
    const std::uint32_t manifest_bytes = read_front(reader, file, digest);
    read_segment_bytes(reader, manifest_bytes, digest, file);
  } catch (const Json::exception& error) {
    reader.fail("its header is not as it should be: " + valid_utf8(error.what()));
  } catch (const Error& error) {
    // Damage to this file is not damage to the database.
    if (error.code() == ErrorCode::kDataLoss) reader.fail(error.what());
    throw;
  }
  return file;
}

}  // namespace landmarkdb
