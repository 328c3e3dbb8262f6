#include "store/manifest.hpp"

#include <array>
#include <cmath>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxArrays = 64;  // format 1 writes eight
constexpr std::size_t kMaxDimensions = 4;

constexpr std::array<std::pair<EntryKind, std::string_view>, 2> kKinds{
    {{EntryKind::kPlace, "place"}, {EntryKind::kObject, "object"}}};
constexpr std::array<std::pair<KeypointMethod, std::string_view>, 4> kMethods{
    {{KeypointMethod::kUniform, "uniform"},
     {KeypointMethod::kStructure, "structure"},
     {KeypointMethod::kIss, "iss"},
     {KeypointMethod::kNarf, "narf"}}};
constexpr std::array<std::pair<DType, std::string_view>, 3> kDTypes{
    {{DType::kFloat32, "f32"}, {DType::kFloat16, "f16"}, {DType::kUint16, "u16"}}};

template <typename Value, std::size_t n>
std::string_view name_of(const std::array<std::pair<Value, std::string_view>, n>& table,
                         Value value) {
  for (const auto& [known, name] : table) {
    if (known == value) return name;
  }
  return "?";
}

template <typename Value, std::size_t n>
std::optional<Value> value_of(const std::array<std::pair<Value, std::string_view>, n>& table,
                              std::string_view name) {
  for (const auto& [value, known] : table) {
    if (known == name) return value;
  }
  return std::nullopt;
}

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json vector_json(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json array_json(const ArrayInfo& array) {
  return {{"name", array.name},
          {"dtype", dtype_name(array.dtype)},
          {"shape", array.shape},
          {"bytes", array.bytes},
          {"sha256", array.sha256}};
}

// Reads fields of one JSON object; every failure names the manifest and the field.
class Reader {
 public:
  Reader(const Json& json, std::string what) : json_(json), what_(std::move(what)) {
    if (!json_.is_object()) fail("is no JSON object");
  }

  [[noreturn]] void fail(const std::string& why) const {
    throw Error(ErrorCode::kDataLoss, what_ + " " + why);
  }
  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(std::string("has no '") + key + "'");
    return *found;
  }
  double number(const char* key) const { return number(at(key), key); }
  bool boolean(const char* key) const {
    if (!at(key).is_boolean())
      fail(std::string("has a '") + key + "' that is neither true nor false");
    return at(key).get<bool>();
  }
  std::string text(const char* key) const {
    if (!at(key).is_string()) fail(std::string("has a '") + key + "' that is no text");
    return at(key).get<std::string>();
  }
  std::uint64_t count(const char* key) const { return count(at(key), key); }
  Eigen::Vector3d vector(const char* key) const {
    const Json& list = at(key);
    if (!list.is_array() || list.size() != 3) {
      fail(std::string("has a '") + key + "' that is not three numbers");
    }
    return {number(list[0], key), number(list[1], key), number(list[2], key)};
  }
  std::vector<std::string> texts(const char* key) const {
    const Json& list = at(key);
    if (!list.is_array()) fail(std::string("has a '") + key + "' that is no list");
    std::vector<std::string> result;
    for (const Json& item : list) {
      if (!item.is_string()) fail(std::string("has a '") + key + "' with an item that is no text");
      result.push_back(item.get<std::string>());
    }
    return result;
  }
  std::vector<std::uint64_t> counts(const char* key) const {
    const Json& list = at(key);
    if (!list.is_array() || list.empty() || list.size() > kMaxDimensions) {
      fail(std::string("has a '") + key + "' that is not a list of 1 to 4 counts");
    }
    std::vector<std::uint64_t> result;
    for (const Json& item : list) result.push_back(count(item, key));
    return result;
  }

 private:
  double number(const Json& value, const char* key) const {
    if (!value.is_number() || !std::isfinite(value.get<double>())) {
      fail(std::string("has a '") + key + "' that is no finite number");
    }
    return value.get<double>();
  }
  std::uint64_t count(const Json& value, const char* key) const {
    if (!value.is_number_unsigned()) fail(std::string("has a '") + key + "' that is no count");
    return value.get<std::uint64_t>();
  }

  const Json& json_;
  std::string what_;
};

ArrayInfo read_array(const Json& json, const std::string& what) {
  const Reader reader(json, what + ": an array of the manifest");
  ArrayInfo array;
  array.name = reader.text("name");
  const std::optional<DType> dtype = value_of(kDTypes, reader.text("dtype"));
  if (!dtype) reader.fail("has the unknown dtype '" + reader.text("dtype") + "'");
  array.dtype = *dtype;
  array.shape = reader.counts("shape");
  array.bytes = reader.count("bytes");
  array.sha256 = reader.text("sha256");
  const std::optional<std::uint64_t> want = array_bytes(array.dtype, array.shape);
  if (!want || *want != array.bytes) {
    reader.fail("('" + array.name + "') says " + std::to_string(array.bytes) +
                " bytes, but its shape wants " + (want ? std::to_string(*want) : "too many"));
  }
  return array;
}

FeatureOptions read_options(const Json& json, const std::string& what) {
  const Reader reader(json, what + ": 'options'");
  FeatureOptions options;
  options.voxel_m = reader.number("voxel_m");
  options.normal_radius_m = reader.number("normal_radius_m");
  options.shot_radius_m = reader.number("shot_radius_m");
  options.keypoint_spacing_m = reader.number("keypoint_spacing_m");
  const std::optional<KeypointMethod> method = value_of(kMethods, reader.text("keypoint_method"));
  if (!method)
    reader.fail("has the unknown keypoint_method '" + reader.text("keypoint_method") + "'");
  options.keypoints = *method;
  return options;
}

CloudCounts read_cloud_counts(const Json& json, const std::string& what) {
  const Reader reader(json, what + ": 'counts'");
  CloudCounts counts;
  counts.points = reader.count("points");
  counts.not_finite = reader.count("not_finite");
  counts.duplicates = reader.count("duplicates");
  counts.out_of_range = reader.count("out_of_range");
  counts.used = reader.count("used");
  return counts;
}

}  // namespace

std::string_view dtype_name(DType dtype) { return name_of(kDTypes, dtype); }
std::string_view kind_name(EntryKind kind) { return name_of(kKinds, kind); }
std::string_view keypoint_method_name(KeypointMethod method) { return name_of(kMethods, method); }

std::optional<EntryKind> kind_from_name(std::string_view name) { return value_of(kKinds, name); }
std::optional<KeypointMethod> keypoint_method_from_name(std::string_view name) {
  return value_of(kMethods, name);
}

std::optional<std::uint64_t> array_bytes(DType dtype, const std::vector<std::uint64_t>& shape) {
  static constexpr std::uint64_t kLimit = std::uint64_t{1} << 62U;
  std::uint64_t bytes = dtype == DType::kFloat32 ? 4 : 2;
  for (const std::uint64_t dimension : shape) {
    if (dimension != 0 && bytes > kLimit / dimension) return std::nullopt;
    bytes *= dimension;
  }
  return bytes;
}

std::string manifest_to_json(const Manifest& m) {
  Json json = {{"format", kSegmentFormat},
               {"kind", kind_name(m.kind)},
               {"options",
                {{"voxel_m", m.options.voxel_m},
                 {"normal_radius_m", m.options.normal_radius_m},
                 {"shot_radius_m", m.options.shot_radius_m},
                 {"keypoint_spacing_m", m.options.keypoint_spacing_m},
                 {"keypoint_method", keypoint_method_name(m.options.keypoints)}}},
               {"origin_m", vector_json(m.origin_m)},
               {"resolution_m", m.resolution_m},
               {"normals_from_viewpoint", m.normals_from_viewpoint},
               {"counts",
                {{"points", m.counts.points},
                 {"not_finite", m.counts.not_finite},
                 {"duplicates", m.counts.duplicates},
                 {"out_of_range", m.counts.out_of_range},
                 {"used", m.counts.used}}},
               {"dropped_keypoints", m.dropped_keypoints},
               {"up", m.up ? vector_json(*m.up) : Json(nullptr)},
               {"sources", m.sources},
               {"warnings", m.warnings},
               {"arrays", Json::array()}};
  for (const ArrayInfo& array : m.arrays) json["arrays"].push_back(array_json(array));
  std::string text = dump(json);
  if (text.size() > kMaxManifestBytes) {
    throw Error(ErrorCode::kInvalidArgument,
                "the names of the sources and the warnings of one scene take " +
                    std::to_string(text.size()) + " bytes, want at most " +
                    std::to_string(kMaxManifestBytes));
  }
  return text;
}

Manifest manifest_from_json(std::string_view text, const std::string& what) {
  if (text.size() > kMaxManifestBytes) {
    throw Error(ErrorCode::kDataLoss,
                what + ": the manifest has " + std::to_string(text.size()) +
                    " bytes, want at most " + std::to_string(kMaxManifestBytes));
  }
  const Json json = Json::parse(text, nullptr, false);
  const Reader reader(json, what + ": the manifest");
  const std::uint64_t format = reader.count("format");
  if (format != static_cast<std::uint64_t>(kSegmentFormat)) {
    throw Error(ErrorCode::kUnimplemented,
                what + " has segment format " + std::to_string(format) + ", this program reads " +
                    std::to_string(kSegmentFormat));
  }
  Manifest m;
  const std::optional<EntryKind> kind = value_of(kKinds, reader.text("kind"));
  if (!kind) reader.fail("has the unknown kind '" + reader.text("kind") + "'");
  m.kind = *kind;
  m.options = read_options(reader.at("options"), what);
  m.origin_m = reader.vector("origin_m");
  m.resolution_m = reader.number("resolution_m");
  m.normals_from_viewpoint = reader.boolean("normals_from_viewpoint");
  m.counts = read_cloud_counts(reader.at("counts"), what);
  m.dropped_keypoints = reader.count("dropped_keypoints");
  if (!reader.at("up").is_null()) m.up = reader.vector("up");
  m.sources = reader.texts("sources");
  m.warnings = reader.texts("warnings");
  const Json& arrays = reader.at("arrays");
  if (!arrays.is_array() || arrays.size() > kMaxArrays)
    reader.fail("has no list of at most 64 arrays");
  std::set<std::string> names;
  for (const Json& array : arrays) {
    m.arrays.push_back(read_array(array, what));
    if (!names.insert(m.arrays.back().name).second) {
      reader.fail("names the array '" + m.arrays.back().name + "' twice");
    }
  }
  return m;
}

std::string texts_to_json(const std::vector<std::string>& texts) { return dump(Json(texts)); }

std::vector<std::string> texts_from_json(std::string_view text) {
  const Json json = Json::parse(text, nullptr, false);
  std::vector<std::string> texts;
  if (!json.is_array()) return texts;
  for (const Json& item : json) {
    if (item.is_string()) texts.push_back(item.get<std::string>());
  }
  return texts;
}

}  // namespace landmarkdb
