#include "engine/matching/code_bytes.hpp"

#include <bit>
#include <cstdint>
#include <cstring>

#include "engine/matching/make_codes.hpp"

namespace landmarkdb {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are written as they lie");

constexpr std::int64_t kVersion = 1;
constexpr const char* kParams = "components 128, rows a list 64, rounds 6";

template <typename Number>
void append(const std::vector<Number>& numbers, std::vector<std::byte>& bytes) {
  const auto more = std::as_bytes(std::span(numbers));
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// Takes numbers from the front; false where there are too few.
template <typename Number>
bool take(std::span<const std::byte>& bytes, std::size_t count, std::vector<Number>& numbers) {
  if (bytes.size() / sizeof(Number) < count) return false;
  numbers.resize(count);
  if (count > 0) std::memcpy(numbers.data(), bytes.data(), count * sizeof(Number));
  bytes = bytes.subspan(count * sizeof(Number));
  return true;
}

}  // namespace

SceneIndexBlob code_format() { return {kVersion, kParams, {}}; }

SceneIndexBlob bytes_of_codes(const DescriptorCodes& codes) {
  SceneIndexBlob blob = code_format();
  const std::vector<std::uint32_t> counts{static_cast<std::uint32_t>(codes.size()),
                                          static_cast<std::uint32_t>(codes.lists())};
  append(counts, blob.codes);
  append(codes.list_start, blob.codes);
  append(codes.rows, blob.codes);
  append(codes.centres, blob.codes);
  append(codes.codes, blob.codes);
  append(codes.tails, blob.codes);
  return blob;
}

SceneIndexBlob make_scene_index(const std::vector<float>& values, const RunContext& context) {
  return bytes_of_codes(make_codes(values, context));
}

std::optional<DescriptorCodes> codes_from(const SceneIndexBlob& blob, std::size_t rows) {
  if (!blob.is_made_like(code_format())) return std::nullopt;
  std::span<const std::byte> bytes = blob.codes;
  std::vector<std::uint32_t> counts;
  DescriptorCodes codes;
  if (!take(bytes, 2, counts) || counts[0] != rows) return std::nullopt;
  const std::size_t lists = counts[1];
  const bool whole = take(bytes, rows == 0 ? 0 : lists + 1, codes.list_start) &&
                     take(bytes, rows, codes.rows) &&
                     take(bytes, lists * kCodeLength, codes.centres) &&
                     take(bytes, rows * kCodeLength, codes.codes) &&
                     take(bytes, rows * kCodeLength, codes.tails) && bytes.empty();
  if (!whole || !fault_of_codes(codes, rows).empty()) return std::nullopt;
  return codes;
}

}  // namespace landmarkdb
