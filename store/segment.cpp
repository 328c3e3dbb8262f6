#include "store/segment.hpp"

#include <cmath>
#include <utility>

#include "store/arrays.hpp"
#include "store/sha256.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kDescriptors = "descriptors";

void add_array(Segment& segment,
               std::string name,
               DType dtype,
               std::vector<std::uint64_t> shape,
               Bytes bytes) {
  ArrayInfo info{std::move(name), dtype, std::move(shape), bytes.size(), sha256_of(bytes)};
  segment.manifest.arrays.push_back(std::move(info));
  segment.arrays.push_back(std::move(bytes));
}

Manifest manifest_of(const SceneRecord& record) {
  Manifest m;
  m.kind = record.kind;
  m.options = record.options;
  m.origin_m = record.prepared.origin;
  m.resolution_m = record.prepared.resolution_m;
  m.normals_from_viewpoint = record.prepared.normals_from_viewpoint;
  m.counts = record.prepared.counts;
  m.dropped_keypoints = record.descriptors.dropped;
  m.up = record.up;
  m.sources = record.sources;
  m.warnings = record.warnings;
  return m;
}

// All that the manifest says.
SceneRecord record_from(const Manifest& manifest, std::string name) {
  SceneRecord record;
  record.name = std::move(name);
  record.kind = manifest.kind;
  record.options = manifest.options;
  record.up = manifest.up;
  record.sources = manifest.sources;
  record.warnings = manifest.warnings;
  record.prepared.origin = manifest.origin_m;
  record.prepared.resolution_m = manifest.resolution_m;
  record.prepared.normals_from_viewpoint = manifest.normals_from_viewpoint;
  record.prepared.counts = manifest.counts;
  record.descriptors.dropped = manifest.dropped_keypoints;
  return record;
}

// Hands out the arrays of a segment by name, each with the type and shape that the caller expects.
class ArrayTaker {
 public:
  ArrayTaker(Segment& segment, const std::string& what) : segment_(segment), what_(what) {}

  // The bytes of an array of rows; `columns` 0 stands for a plain list.
  Bytes take(std::string_view name, DType dtype, std::uint64_t columns) {
    for (std::size_t i = 0; i < segment_.manifest.arrays.size(); ++i) {
      const ArrayInfo& info = segment_.manifest.arrays[i];
      if (info.name != name) continue;
      const bool fits = columns == 0 ? info.shape.size() == 1
                                     : info.shape.size() == 2 && info.shape[1] == columns;
      if (info.dtype != dtype || !fits) {
        fail(name,
             "does not have the type and shape it should: " + std::string(dtype_name(dtype)) +
                 (columns == 0 ? " x n" : " x n x " + std::to_string(columns)));
      }
      const std::uint64_t want = array_bytes(info.dtype, info.shape).value_or(0);
      if (segment_.arrays[i].size() != want) {
        fail(name,
             "has " + std::to_string(segment_.arrays[i].size()) + " bytes, want " +
                 std::to_string(want));
      }
      return std::move(segment_.arrays[i]);
    }
    fail(name, "is missing");
  }

 private:
  [[noreturn]] void fail(std::string_view name, const std::string& why) const {
    throw Error(ErrorCode::kDataLoss, what_ + ": array '" + std::string(name) + "' " + why);
  }

  Segment& segment_;
  const std::string& what_;
};

// Metres from the origin of the record: more than the Earth is wide is no scan.
constexpr float kMaxLocal_m = 1e7F;
// Metres from the origin of the map: eastings that begin with their zone's number reach 6e7.
constexpr double kMaxOrigin_m = 1e9;

// False for what is not finite too.
template <typename Vectors>
bool all_within(const Vectors& vectors, float limit) {
  for (const auto& v : vectors) {
    if (!(v.cwiseAbs().array() < limit).all()) return false;
  }
  return true;
}

template <typename Vectors>
bool all_finite(const Vectors& vectors) {
  for (const auto& v : vectors) {
    if (!v.allFinite()) return false;
  }
  return true;
}

bool all_options_finite(const FeatureOptions& options) {
  for (const double value : {options.voxel_m,
                             options.normal_radius_m,
                             options.shot_radius_m,
                             options.keypoint_spacing_m}) {
    if (!std::isfinite(value) || value < 0.0) return false;
  }
  return true;
}

// The lengths that others divide by. Without descriptors there is nothing that has a radius.
bool lengths_are_positive(const SceneRecord& record) {
  if (!(record.options.voxel_m > 0.0) || !(record.prepared.resolution_m > 0.0)) return false;
  return record.descriptors.size() == 0 ||
         (record.options.normal_radius_m > 0.0 && record.options.shot_radius_m > 0.0);
}

// The first thing wrong with the record; empty where all is well.
std::string fault_of(const SceneRecord& record, SceneParts parts) {
  const PreparedCloud& cloud = record.prepared;
  const DescriptorSet& set = record.descriptors;
  const auto count = [](std::size_t n) { return std::to_string(n); };
  if (cloud.normals.size() != cloud.size()) {
    return "has " + count(cloud.normals.size()) + " normals for " + count(cloud.size()) + " points";
  }
  if (!cloud.viewpoint_index.empty() && cloud.viewpoint_index.size() != cloud.size()) {
    return "has " + count(cloud.viewpoint_index.size()) + " viewpoint indices for " +
           count(cloud.size()) + " points";
  }
  for (const std::uint16_t index : cloud.viewpoint_index) {
    if (index >= cloud.viewpoints.size()) {
      return "has the viewpoint index " + count(index) + " but " + count(cloud.viewpoints.size()) +
             " viewpoints";
    }
  }
  const std::size_t want_values = parts == SceneParts::kWhole ? set.size() * kShotLength : 0;
  if (set.normals.size() != set.size() || set.frames.size() != set.size() ||
      set.values.size() != want_values) {
    return "has " + count(set.size()) + " keypoints, " + count(set.normals.size()) +
           " keypoint normals, " + count(set.frames.size()) + " frames and " +
           count(set.values.size()) + " descriptor values, want n, n, n and n * 352";
  }
  if (!all_finite(cloud.points) || !all_finite(cloud.normals) || !all_finite(cloud.viewpoints)) {
    return "has points, normals or viewpoints that are not finite";
  }
  if (!all_finite(set.keypoints) || !all_finite(set.normals) || !all_finite(set.frames)) {
    return "has keypoints, keypoint normals or frames that are not finite";
  }
  for (const float value : set.values) {
    if (!std::isfinite(value)) return "has descriptor values that are not finite";
  }
  if (!all_within(cloud.points, kMaxLocal_m) || !all_within(set.keypoints, kMaxLocal_m) ||
      !all_within(cloud.viewpoints, static_cast<float>(kMaxOrigin_m))) {
    return "has points, keypoints or viewpoints that are too far away, want points within 1e7 m";
  }
  if (!(cloud.origin.cwiseAbs().array() < kMaxOrigin_m).all() ||
      !std::isfinite(cloud.resolution_m) || !all_options_finite(record.options)) {
    return "has an origin, resolution or option that is no finite number, or an origin past 1e9 m";
  }
  if (!lengths_are_positive(record)) {
    return "has a resolution, voxel or radius of zero, want more";
  }
  if (record.up && (!record.up->allFinite() || record.up->norm() == 0.0)) {
    return "has an up direction without a direction";
  }
  return {};
}

}  // namespace

std::uint64_t Segment::bytes() const {
  std::uint64_t total = 0;
  for (const auto& array : arrays) total += array.size();
  return total;
}

void validate_record(const SceneRecord& record, const std::string& what, ErrorCode code) {
  const std::string fault = fault_of(record, SceneParts::kWhole);
  if (!fault.empty()) throw Error(code, what + " " + fault);
}

Segment encode_segment(const SceneRecord& record) {
  const std::string what = "scene '" + record.name + "'";
  validate_record(record, what, ErrorCode::kInvalidArgument);
  const PreparedCloud& cloud = record.prepared;
  const DescriptorSet& set = record.descriptors;
  const std::uint64_t n = cloud.size();
  const std::uint64_t k = set.size();
  Segment segment;
  segment.manifest = manifest_of(record);
  add_array(segment, "points", DType::kFloat32, {n, 3}, bytes_of(cloud.points));
  add_array(segment, "normals", DType::kFloat32, {n, 3}, bytes_of(cloud.normals));
  add_array(segment,
            "viewpoints",
            DType::kFloat32,
            {cloud.viewpoints.size(), 3},
            bytes_of(cloud.viewpoints));
  add_array(segment,
            "viewpoint_index",
            DType::kUint16,
            {cloud.viewpoint_index.size()},
            bytes_of(cloud.viewpoint_index));
  add_array(segment, "keypoints", DType::kFloat32, {k, 3}, bytes_of(set.keypoints));
  add_array(segment, "keypoint_normals", DType::kFloat32, {k, 3}, bytes_of(set.normals));
  add_array(segment, "keypoint_frames", DType::kFloat32, {k, 4}, quaternions_of(set.frames, what));
  add_array(segment,
            std::string(kDescriptors),
            DType::kFloat16,
            {k, kShotLength},
            halves_of(set.values, what));
  segment.manifest_json = manifest_to_json(segment.manifest);
  segment.sha256 = sha256_of(segment.manifest_json);
  return segment;
}

SceneRecord outline_of(const Manifest& manifest, std::string name, const std::string& what) {
  SceneRecord record = record_from(manifest, std::move(name));
  const std::string fault = fault_of(record, SceneParts::kSurface);
  if (!fault.empty()) throw Error(ErrorCode::kDataLoss, what + " " + fault);
  return record;
}

bool is_part(std::string_view array, SceneParts parts) {
  return parts == SceneParts::kWhole || array != kDescriptors;
}

SceneRecord decode_segment(Segment segment,
                           std::string name,
                           const std::string& what,
                           SceneParts parts) {
  ArrayTaker arrays(segment, what);
  SceneRecord record = record_from(segment.manifest, std::move(name));
  PreparedCloud& cloud = record.prepared;
  DescriptorSet& set = record.descriptors;
  cloud.points = vectors_from(arrays.take("points", DType::kFloat32, 3));
  cloud.normals = vectors_from(arrays.take("normals", DType::kFloat32, 3));
  cloud.viewpoints = vectors_from(arrays.take("viewpoints", DType::kFloat32, 3));
  cloud.viewpoint_index = indices_from(arrays.take("viewpoint_index", DType::kUint16, 0));
  set.normals = vectors_from(arrays.take("keypoint_normals", DType::kFloat32, 3));
  set.keypoints = vectors_from(arrays.take("keypoints", DType::kFloat32, 3));
  set.frames = frames_from(arrays.take("keypoint_frames", DType::kFloat32, 4), what);
  if (parts == SceneParts::kWhole) {
    set.values =
        unit_rows_from(arrays.take(kDescriptors, DType::kFloat16, kShotLength), kShotLength);
  }
  const std::string fault = fault_of(record, parts);
  if (!fault.empty()) throw Error(ErrorCode::kDataLoss, what + " " + fault);
  return record;
}

void verify_array(const ArrayInfo& info,
                  std::span<const std::byte> bytes,
                  const std::string& what) {
  if (bytes.size() != info.bytes) {
    throw Error(ErrorCode::kDataLoss,
                what + ": array '" + info.name + "' has " + std::to_string(bytes.size()) +
                    " bytes, want " + std::to_string(info.bytes));
  }
  const std::string digest = sha256_of(bytes);
  if (digest != info.sha256) {
    throw Error(ErrorCode::kDataLoss,
                what + ": array '" + info.name + "' is damaged: its digest is " +
                    digest.substr(0, 12) + "..., want " + info.sha256.substr(0, 12) + "...");
  }
}

}  // namespace landmarkdb
