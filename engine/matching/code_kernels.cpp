#include "engine/matching/code_kernels.hpp"

#include <cstring>
#include <initializer_list>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace landmarkdb {
namespace {

constexpr std::size_t kQuads = kCodeLength / 4;  // of bytes, a code
constexpr std::size_t kGroupBytes = kCodeLength * kCodeGroup;

void baseline_group(const std::int8_t* query,
                    const std::uint8_t* bytes,
                    const std::int32_t* bias,
                    std::int32_t* out) {
  std::int32_t sum[kCodeGroup] = {};
  for (std::size_t quad = 0; quad < kQuads; ++quad) {
    for (std::size_t i = 0; i < kCodeGroup; ++i) {
      const std::uint8_t* b = bytes + (quad * kCodeGroup + i) * 4;
      for (std::size_t j = 0; j < 4; ++j) sum[i] += query[quad * 4 + j] * b[j];
    }
  }
  for (std::size_t i = 0; i < kCodeGroup; ++i) out[i] = 2 * sum[i] + bias[i];
}

using Group = void (*)(const std::int8_t*, const std::uint8_t*, const std::int32_t*, std::int32_t*);

template <Group group>
void scores_of(const std::int8_t* query,
               const std::uint8_t* bytes,
               const std::int32_t* bias,
               std::size_t groups,
               std::int32_t* out) {
  for (std::size_t g = 0; g < groups; ++g) {
    group(query, bytes + g * kGroupBytes, bias + g * kCodeGroup, out + g * kCodeGroup);
  }
}

template <Group group>
std::size_t above_of(const std::int8_t* query,
                     const std::uint8_t* bytes,
                     const std::int32_t* bias,
                     std::size_t groups,
                     std::int32_t floor,
                     std::int32_t* scores,
                     std::uint32_t* places) {
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups; ++g) {
    std::int32_t score[kCodeGroup];
    group(query, bytes + g * kGroupBytes, bias + g * kCodeGroup, score);
    for (std::size_t i = 0; i < kCodeGroup; ++i) {
      scores[count] = score[i];
      places[count] = static_cast<std::uint32_t>(g * kCodeGroup + i);
      count += score[i] > floor ? 1U : 0U;
    }
  }
  return count;
}

// Loops that the compiler turns into what the function they are inlined into may use.
[[gnu::always_inline]] inline std::int32_t squared_distance_loop(const std::int8_t* a,
                                                                 const std::int8_t* b) {
  std::int32_t sum = 0;
  for (std::size_t j = 0; j < kCodeLength; ++j) {
    const auto difference = static_cast<std::int16_t>(a[j] - b[j]);
    sum += difference * difference;
  }
  return sum;
}

[[gnu::always_inline]] inline void project_loop(const std::int16_t* row,
                                                const std::int16_t* components,
                                                std::size_t count,
                                                std::int32_t* sums) {
  for (std::size_t d = 0; d < count; ++d) {
    const std::int16_t* component = components + d * kShotLength;
    std::int32_t sum = 0;
    for (std::size_t j = 0; j < kShotLength; ++j) sum += row[j] * component[j];
    sums[d] = sum;
  }
}

std::int32_t baseline_squared(const std::int8_t* a, const std::int8_t* b) {
  return squared_distance_loop(a, b);
}
void baseline_project(const std::int16_t* row,
                      const std::int16_t* components,
                      std::size_t count,
                      std::int32_t* sums) {
  project_loop(row, components, count, sums);
}

constexpr CodeKernels kBaseline{
    scores_of<baseline_group>, above_of<baseline_group>, baseline_squared, baseline_project};

#if defined(__x86_64__)

// Sixteen bits a product: a sum of two 8-bit products may not fit what _mm256_maddubs_epi16 gives.
[[gnu::target("avx2")]] void avx2_group(const std::int8_t* query,
                                        const std::uint8_t* bytes,
                                        const std::int32_t* bias,
                                        std::int32_t* out) {
  __m256i sum[4] = {};  // four codes each, two halves of each sum
  for (std::size_t quad = 0; quad < kQuads; ++quad) {
    std::int32_t four = 0;
    std::memcpy(&four, query + quad * 4, sizeof four);
    const __m256i q = _mm256_cvtepi8_epi16(_mm_set1_epi32(four));
    for (std::size_t i = 0; i < 4; ++i) {
      const auto* b = reinterpret_cast<const __m128i*>(bytes + (quad * 4 + i) * 16);
      const __m256i wide = _mm256_cvtepu8_epi16(_mm_loadu_si128(b));
      sum[i] = _mm256_add_epi32(sum[i], _mm256_madd_epi16(q, wide));
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    constexpr int kMiddleSwapped = 0xD8;
    const __m256i dots =
        _mm256_permute4x64_epi64(_mm256_hadd_epi32(sum[2 * i], sum[2 * i + 1]), kMiddleSwapped);
    const __m256i b = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(bias + 8 * i));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(out + 8 * i),
                        _mm256_add_epi32(_mm256_slli_epi32(dots, 1), b));
  }
}

[[gnu::target("avx2")]] std::int32_t avx2_squared(const std::int8_t* a, const std::int8_t* b) {
  return squared_distance_loop(a, b);
}
[[gnu::target("avx2")]] void avx2_project(const std::int16_t* row,
                                          const std::int16_t* components,
                                          std::size_t count,
                                          std::int32_t* sums) {
  project_loop(row, components, count, sums);
}

constexpr CodeKernels kAvx2{
    scores_of<avx2_group>, above_of<avx2_group>, avx2_squared, avx2_project};

// The query stays in sixteen registers; two sums run side by side, as one would wait for itself.
#define LANDMARKDB_VNNI [[gnu::target("avx512f,avx512bw,avx512vnni")]]

struct VnniQuery {
  __m512i quad[kQuads];
};

LANDMARKDB_VNNI [[gnu::always_inline]] inline VnniQuery load_query(const std::int8_t* query) {
  VnniQuery result;
  for (std::size_t i = 0; i < kQuads; ++i) {
    std::int32_t four = 0;
    std::memcpy(&four, query + i * 4, sizeof four);
    result.quad[i] = _mm512_set1_epi32(four);
  }
  return result;
}

LANDMARKDB_VNNI [[gnu::always_inline]] inline __m512i vnni_group(const VnniQuery& query,
                                                                 const std::uint8_t* bytes,
                                                                 const std::int32_t* bias) {
  __m512i even = _mm512_setzero_si512();
  __m512i odd = _mm512_setzero_si512();
  for (std::size_t quad = 0; quad < kQuads; quad += 2) {
    even = _mm512_dpbusd_epi32(even, _mm512_loadu_si512(bytes + quad * 64), query.quad[quad]);
    odd =
        _mm512_dpbusd_epi32(odd, _mm512_loadu_si512(bytes + quad * 64 + 64), query.quad[quad + 1]);
  }
  const __m512i dots = _mm512_add_epi32(even, odd);
  return _mm512_add_epi32(_mm512_add_epi32(dots, dots), _mm512_loadu_si512(bias));
}

LANDMARKDB_VNNI void vnni_scores(const std::int8_t* query,
                                 const std::uint8_t* bytes,
                                 const std::int32_t* bias,
                                 std::size_t groups,
                                 std::int32_t* out) {
  const VnniQuery q = load_query(query);
  for (std::size_t g = 0; g < groups; ++g) {
    _mm512_storeu_si512(out + g * kCodeGroup,
                        vnni_group(q, bytes + g * kGroupBytes, bias + g * kCodeGroup));
  }
}

LANDMARKDB_VNNI std::size_t vnni_above(const std::int8_t* query,
                                       const std::uint8_t* bytes,
                                       const std::int32_t* bias,
                                       std::size_t groups,
                                       std::int32_t floor,
                                       std::int32_t* scores,
                                       std::uint32_t* places) {
  const VnniQuery q = load_query(query);
  const __m512i least = _mm512_set1_epi32(floor);
  __m512i place = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  std::size_t count = 0;
  // Without a branch on whether there are any: in half of the groups there are.
  for (std::size_t g = 0; g < groups; ++g) {
    const __m512i score = vnni_group(q, bytes + g * kGroupBytes, bias + g * kCodeGroup);
    const __mmask16 above = _mm512_cmpgt_epi32_mask(score, least);
    _mm512_storeu_si512(scores + count, _mm512_maskz_compress_epi32(above, score));
    _mm512_storeu_si512(places + count, _mm512_maskz_compress_epi32(above, place));
    count += static_cast<std::size_t>(__builtin_popcount(above));
    place = _mm512_add_epi32(place, _mm512_set1_epi32(kCodeGroup));
  }
  return count;
}

#undef LANDMARKDB_VNNI

constexpr CodeKernels kVnni{vnni_scores, vnni_above, avx2_squared, avx2_project};

#endif

}  // namespace

void PackedCodes::reserve(std::size_t groups) {
  bytes.reserve(groups * kGroupBytes);
  bias.reserve(groups * kCodeGroup);
}

void PackedCodes::append(std::span<const std::int8_t> codes) {
  const std::size_t count = codes.size() / kCodeLength;
  const std::size_t first = groups();
  const std::size_t more = (count + kCodeGroup - 1) / kCodeGroup;
  bytes.resize((first + more) * kGroupBytes, 128);
  bias.resize((first + more) * kCodeGroup, kNoCode);
  for (std::size_t i = 0; i < count; ++i) {
    const std::int8_t* code = codes.data() + i * kCodeLength;
    std::uint8_t* group = bytes.data() + (first + i / kCodeGroup) * kGroupBytes;
    std::int32_t squared = 0;
    for (std::size_t j = 0; j < kCodeLength; ++j) squared += code[j] * code[j];
    bias[first * kCodeGroup + i] = -squared;
    for (std::size_t quad = 0; quad < kQuads; ++quad) {
      std::uint32_t four = 0;
      std::memcpy(&four, code + 4 * quad, sizeof four);
      four ^= 0x80808080U;  // each + 128
      std::memcpy(group + (quad * kCodeGroup + i % kCodeGroup) * 4, &four, sizeof four);
    }
  }
}

const CodeKernels* code_kernels(const char* instruction_set) {
#if defined(__x86_64__)
  if (std::strcmp(instruction_set, "avx512vnni") == 0) {
    const bool has = __builtin_cpu_supports("avx512f") != 0 &&
                     __builtin_cpu_supports("avx512bw") != 0 &&
                     __builtin_cpu_supports("avx512vnni") != 0;
    return has ? &kVnni : nullptr;
  }
  if (std::strcmp(instruction_set, "avx2") == 0) {
    return __builtin_cpu_supports("avx2") != 0 ? &kAvx2 : nullptr;
  }
#endif
  return std::strcmp(instruction_set, "baseline") == 0 ? &kBaseline : nullptr;
}

const CodeKernels& code_kernels() {
  static const CodeKernels* const best = [] {
    for (const char* name : {"avx512vnni", "avx2"}) {
      if (const CodeKernels* kernels = code_kernels(name)) return kernels;
    }
    return &kBaseline;
  }();
  return *best;
}

}  // namespace landmarkdb
