#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "engine/types/descriptor_codes.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {

// Codes that are compared at once lie interleaved: groups of 16 codes, of each four bytes in turn,
// an element as its value + 128.
inline constexpr std::size_t kCodeGroup = 16;

struct PackedCodes {
  std::vector<std::uint8_t> bytes;  // G x kCodeLength / 4 x kCodeGroup x 4
  std::vector<std::int32_t> bias;   // G x kCodeGroup: minus the squared length; kNoCode: no code

  static constexpr std::int32_t kNoCode = std::numeric_limits<std::int32_t>::min() / 2;

  std::size_t groups() const { return bias.size() / kCodeGroup; }
  void reserve(std::size_t groups);
  // Begins a new group and appends rows of kCodeLength; fills up the last group.
  void append(std::span<const std::int8_t> codes);
};

// Codes that were found, each with its score, and its place counted from the first group given.
struct CodeHits {
  std::vector<std::int32_t> scores;
  std::vector<std::uint32_t> places;

  // Room for hits among so many codes: kernels write a whole group at a time.
  void make_room(std::size_t codes) {
    scores.resize(codes + kCodeGroup);
    places.resize(codes + kCodeGroup);
  }
};

// The score of a code b for a query a is 2 sum(a_j (b_j + 128)) - |b|^2: within one query it falls
// as the squared distance grows. Whole numbers, so the same on every machine; the best instruction
// set is chosen when the program starts. Thread-safe.
struct CodeKernels {
  // Writes the scores of all codes of `groups` groups.
  void (*scores)(const std::int8_t* query,
                 const std::uint8_t* bytes,
                 const std::int32_t* bias,
                 std::size_t groups,
                 std::int32_t* out);
  // Writes the codes whose score is above `floor`, in order; how many there are. There is room for
  // all and a group more; what lies behind the hits is left as it may be.
  std::size_t (*above)(const std::int8_t* query,
                       const std::uint8_t* bytes,
                       const std::int32_t* bias,
                       std::size_t groups,
                       std::int32_t floor,
                       std::int32_t* scores,
                       std::uint32_t* places);
  // Squared distance of two codes, plainly one after the other.
  std::int32_t (*squared_distance)(const std::int8_t* a, const std::int8_t* b);
  // Writes the inner products of `row` with `count` rows of `components`, all of kShotLength.
  void (*project)(const std::int16_t* row,
                  const std::int16_t* components,
                  std::size_t count,
                  std::int32_t* sums);
};
const CodeKernels& code_kernels();

// Those of one instruction set by name, "baseline", "avx2" or "avx512vnni"; null where the machine
// lacks it.
const CodeKernels* code_kernels(const char* instruction_set);

}  // namespace landmarkdb
