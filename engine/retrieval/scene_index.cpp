#include "engine/retrieval/scene_index.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "engine/matching/make_codes.hpp"

namespace landmarkdb {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
static_assert(sizeof(PackedRotation) == 4 * sizeof(std::int16_t));

constexpr std::int64_t kVersion = 3;
constexpr const char* kParams = "components 128, rows a list 64, rounds 6, outline of 4 voxels";

template <typename Value>
void append(const std::vector<Value>& values, std::vector<std::byte>& bytes) {
  const auto more = std::as_bytes(std::span(values));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Takes values from the front; false where there are too few.
template <typename Value>
bool take(std::span<const std::byte>& bytes, std::size_t count, std::vector<Value>& values) {
  if (bytes.size() / sizeof(Value) < count) return false;
  values.resize(count);
  if (count > 0)
    std::memcpy(static_cast<void*>(values.data()), bytes.data(), count * sizeof(Value));
  bytes = bytes.subspan(count * sizeof(Value));
  return true;
}

constexpr float kMostLocal_m = 1e7F;  // as a scene's own points
constexpr float kMostOfNormal = 1.01F;

// Numbers that are none are not within anything.
bool all_within(const std::vector<Eigen::Vector3f>& vectors, float most) {
  return std::all_of(vectors.begin(), vectors.end(), [&](const Eigen::Vector3f& v) {
    return (v.array().abs() <= most).all();
  });
}

bool is_sound(const PlaceOutline& outline) {
  return all_within(outline.keypoints, kMostLocal_m) &&
         all_within(outline.surface.points, kMostLocal_m) &&
         all_within(outline.surface.normals, kMostOfNormal);
}

}  // namespace

SceneIndexBlob scene_index_format() { return {kVersion, kParams, {}}; }

SceneIndexBlob make_scene_index(const SceneRecord& record, const RunContext& context) {
  const DescriptorCodes codes = make_codes(record.descriptors.values, context);
  const PlaceOutline outline =
      record.kind == EntryKind::kPlace ? make_place_outline(record) : PlaceOutline{};
  SceneIndexBlob blob = scene_index_format();
  const std::vector<std::uint32_t> counts{
      static_cast<std::uint32_t>(codes.size()),
      static_cast<std::uint32_t>(codes.lists()),
      static_cast<std::uint32_t>(outline.keypoints.size()),
      static_cast<std::uint32_t>(outline.surface.points.size())};
  append(counts, blob.codes);
  append(codes.list_start, blob.codes);
  append(codes.rows, blob.codes);
  append(codes.centres, blob.codes);
  append(codes.codes, blob.codes);
  append(outline.keypoints, blob.codes);
  append(outline.frames, blob.codes);
  append(outline.surface.points, blob.codes);
  append(outline.surface.normals, blob.codes);
  append(codes.tails, blob.tails);
  return blob;
}

std::optional<SceneIndex> scene_index_from(const SceneIndexBlob& blob,
                                           EntryKind kind,
                                           std::size_t rows,
                                           bool with_tails) {
  if (!blob.is_made_like(scene_index_format())) return std::nullopt;
  std::span<const std::byte> bytes = blob.codes;
  std::span<const std::byte> tail_bytes = blob.tails;
  std::vector<std::uint32_t> counts;
  SceneIndex index;
  DescriptorCodes& codes = index.codes;
  PlaceOutline& outline = index.outline;
  if (!take(bytes, 4, counts) || counts[0] != rows) return std::nullopt;
  const std::size_t lists = counts[1];
  const std::size_t keypoints = counts[2];
  if (keypoints != (kind == EntryKind::kPlace ? rows : 0)) return std::nullopt;
  const bool whole =
      take(bytes, rows == 0 ? 0 : lists + 1, codes.list_start) && take(bytes, rows, codes.rows) &&
      take(bytes, lists * kCodeLength, codes.centres) &&
      take(bytes, rows * kCodeLength, codes.codes) && take(bytes, keypoints, outline.keypoints) &&
      take(bytes, keypoints, outline.frames) && take(bytes, counts[3], outline.surface.points) &&
      take(bytes, counts[3], outline.surface.normals) && bytes.empty();
  if (!whole || !fault_of_codes(codes, rows).empty()) return std::nullopt;
  if (with_tails && !(take(tail_bytes, rows * kCodeLength, codes.tails) && tail_bytes.empty())) {
    return std::nullopt;
  }
  return is_sound(outline) ? std::optional(std::move(index)) : std::nullopt;
}

std::optional<SceneIndex> scene_index_of(const CatalogEntry& stored,
                                         bool with_tails,
                                         const RunContext& context) {
  const std::optional<SceneIndexBlob> blob = stored.source->index(with_tails, context);
  if (!blob) return std::nullopt;
  return scene_index_from(
      *blob, stored.record->kind, static_cast<std::size_t>(stored.keypoints), with_tails);
}

}  // namespace landmarkdb
