#include "engine/retrieval/scene_index.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "engine/matching/make_codes.hpp"

namespace landmarkdb {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));

constexpr std::int64_t kVersion = 2;
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

bool all_finite(const std::vector<Eigen::Vector3f>& vectors) {
  for (const Eigen::Vector3f& v : vectors) {
    if (!v.allFinite()) return false;
  }
  return true;
}

}  // namespace

SceneIndexBlob scene_index_format() { return {kVersion, kParams, {}}; }

SceneIndexBlob make_scene_index(const SceneRecord& record, const RunContext& context) {
  const DescriptorCodes codes = make_codes(record.descriptors.values, context);
  const PlaceOutline outline =
      record.kind == EntryKind::kPlace ? make_place_outline(record.prepared) : PlaceOutline{};
  SceneIndexBlob blob = scene_index_format();
  const std::vector<std::uint32_t> counts{static_cast<std::uint32_t>(codes.size()),
                                          static_cast<std::uint32_t>(codes.lists()),
                                          static_cast<std::uint32_t>(outline.points.size())};
  append(counts, blob.codes);
  append(codes.list_start, blob.codes);
  append(codes.rows, blob.codes);
  append(codes.centres, blob.codes);
  append(codes.codes, blob.codes);
  append(codes.tails, blob.codes);
  append(outline.points, blob.codes);
  append(outline.normals, blob.codes);
  return blob;
}

std::optional<SceneIndex> scene_index_from(const SceneIndexBlob& blob, std::size_t rows) {
  if (!blob.is_made_like(scene_index_format())) return std::nullopt;
  std::span<const std::byte> bytes = blob.codes;
  std::vector<std::uint32_t> counts;
  SceneIndex index;
  DescriptorCodes& codes = index.codes;
  if (!take(bytes, 3, counts) || counts[0] != rows) return std::nullopt;
  const std::size_t lists = counts[1];
  const bool whole = take(bytes, rows == 0 ? 0 : lists + 1, codes.list_start) &&
                     take(bytes, rows, codes.rows) &&
                     take(bytes, lists * kCodeLength, codes.centres) &&
                     take(bytes, rows * kCodeLength, codes.codes) &&
                     take(bytes, rows * kCodeLength, codes.tails) &&
                     take(bytes, counts[2], index.outline.points) &&
                     take(bytes, counts[2], index.outline.normals) && bytes.empty();
  if (!whole || !fault_of_codes(codes, rows).empty()) return std::nullopt;
  if (!all_finite(index.outline.points) || !all_finite(index.outline.normals)) return std::nullopt;
  return index;
}

std::optional<SceneIndex> scene_index_of(const SceneSource& source,
                                         std::size_t rows,
                                         const RunContext& context) {
  const std::optional<SceneIndexBlob> stored = source.index(context);
  return stored ? scene_index_from(*stored, rows) : std::nullopt;
}

}  // namespace landmarkdb
