#include "engine/matching/make_codes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include "engine/base/parallel.hpp"
#include "engine/matching/code_basis.hpp"
#include "engine/matching/code_kernels.hpp"
#include "engine/types/features.hpp"

namespace landmarkdb {
namespace {

constexpr std::string_view kStage = "index";

// Lists of half and of twice the length cost a query more, in choosing them or in reading them.
constexpr std::size_t kRowsAList = 64;
// Bounds the time for what is larger than any one place: a round is rows x lists.
constexpr std::size_t kMostLists = 16'384;
constexpr int kRounds = 6;                 // more do not show in the recall
constexpr std::size_t kRowsAtOnce = 1024;  // between two looks at the stop request

constexpr int kLargest = 127;

// Codes the row at `values` to `parts`: its code and its tail.
void code_row(const CodeBasis& basis,
              const float* values,
              const std::array<std::int8_t*, 2>& parts) {
  std::array<std::int16_t, kShotLength> row{};
  for (std::size_t j = 0; j < kShotLength; ++j) {
    row[j] = static_cast<std::int16_t>(std::clamp(values[j], 0.0F, 1.0F) * kRowSteps + 0.5F);
  }
  std::array<std::int32_t, kCodeComponents> sums{};
  code_kernels().project(row.data(), basis.components.data(), kCodeComponents, sums.data());
  for (std::size_t d = 0; d < kCodeComponents; ++d) {
    const float steps = static_cast<float>(sums[d] - basis.mean[d]) / basis.step;
    const int rounded = static_cast<int>(std::floor(steps + 0.5F));
    parts[d / kCodeLength][d % kCodeLength] =
        static_cast<std::int8_t>(std::clamp(rounded, -kLargest, kLargest));
  }
}

std::span<const std::int8_t> code_at(std::span<const std::int8_t> codes, std::size_t i) {
  return codes.subspan(i * kCodeLength, kCodeLength);
}

// The nearest centre of each code, the lower one of two as near.
void assign(std::span<const std::int8_t> codes,
            const PackedCodes& centres,
            std::vector<std::uint32_t>& list_of,
            const RunContext& context) {
  const CodeKernels& kernels = code_kernels();
  parallel_chunks(list_of.size(), context.threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> scores(centres.bias.size());
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kRowsAtOnce == 0 && context.should_stop()) return;
      kernels.scores(code_at(codes, i).data(),
                     centres.bytes.data(),
                     centres.bias.data(),
                     centres.groups(),
                     scores.data());
      list_of[i] = static_cast<std::uint32_t>(std::max_element(scores.begin(), scores.end()) -
                                              scores.begin());
    }
  });
  context.check(kStage);
}

// The mean of each list, rounded; a list without rows keeps its centre.
void move_centres(std::span<const std::int8_t> codes,
                  const std::vector<std::uint32_t>& list_of,
                  std::vector<std::int8_t>& centres) {
  std::vector<std::int64_t> sums(centres.size());
  std::vector<std::int64_t> counts(centres.size() / kCodeLength);
  for (std::size_t i = 0; i < list_of.size(); ++i) {
    ++counts[list_of[i]];
    std::int64_t* sum = sums.data() + list_of[i] * kCodeLength;
    for (std::size_t d = 0; d < kCodeLength; ++d) sum[d] += code_at(codes, i)[d];
  }
  for (std::size_t l = 0; l < counts.size(); ++l) {
    if (counts[l] == 0) continue;
    for (std::size_t d = 0; d < kCodeLength; ++d) {
      const std::int64_t sum = sums[l * kCodeLength + d];
      const std::int64_t half = sum < 0 ? -(counts[l] / 2) : counts[l] / 2;
      centres[l * kCodeLength + d] = static_cast<std::int8_t>((sum + half) / counts[l]);
    }
  }
}

// Sorts the rows into their lists; within one they keep their order. Lists without rows are left
// out.
DescriptorCodes sort_out(const RowCodes& row_codes,
                         const std::vector<std::int8_t>& centres,
                         const std::vector<std::uint32_t>& list_of) {
  DescriptorCodes result;
  result.rows.resize(list_of.size());
  std::iota(result.rows.begin(), result.rows.end(), 0U);
  std::stable_sort(result.rows.begin(), result.rows.end(), [&](std::uint32_t a, std::uint32_t b) {
    return list_of[a] < list_of[b];
  });
  result.codes.reserve(row_codes.codes.size());
  result.tails.reserve(row_codes.tails.size());
  std::uint32_t list = 0;
  for (std::size_t place = 0; place < result.rows.size(); ++place) {
    const std::uint32_t row = result.rows[place];
    if (place == 0 || list_of[row] != list) {
      list = list_of[row];
      const auto centre = code_at(centres, list);
      result.list_start.push_back(static_cast<std::uint32_t>(place));
      result.centres.insert(result.centres.end(), centre.begin(), centre.end());
    }
    const auto code = code_at(row_codes.codes, row);
    const auto tail = code_at(row_codes.tails, row);
    result.codes.insert(result.codes.end(), code.begin(), code.end());
    result.tails.insert(result.tails.end(), tail.begin(), tail.end());
  }
  result.list_start.push_back(static_cast<std::uint32_t>(result.rows.size()));
  return result;
}

}  // namespace

RowCodes code_rows(std::span<const float> values, const RunContext& context) {
  const CodeBasis& basis = code_basis();
  const std::size_t count = values.size() / kShotLength;
  RowCodes result;
  result.codes.resize(count * kCodeLength);
  result.tails.resize(count * kCodeLength);
  parallel_chunks(count, context.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (i % kRowsAtOnce == 0 && context.should_stop()) return;
      code_row(basis,
               values.data() + i * kShotLength,
               {result.codes.data() + i * kCodeLength, result.tails.data() + i * kCodeLength});
    }
  });
  context.check(kStage);
  return result;
}

DescriptorCodes make_codes(std::span<const float> values, const RunContext& context) {
  const RowCodes row_codes = code_rows(values, context);
  const std::vector<std::int8_t>& codes = row_codes.codes;
  const std::size_t count = codes.size() / kCodeLength;
  if (count == 0) return {};
  const std::size_t lists = std::clamp<std::size_t>(count / kRowsAList, 1, kMostLists);
  std::vector<std::int8_t> centres;
  for (std::size_t l = 0; l < lists; ++l) {
    const auto code = code_at(codes, l * count / lists);
    centres.insert(centres.end(), code.begin(), code.end());
  }
  std::vector<std::uint32_t> list_of(count);
  for (int round = 0;; ++round) {
    PackedCodes packed;
    packed.append(centres);
    assign(codes, packed, list_of, context);
    if (round == kRounds) break;
    move_centres(codes, list_of, centres);
  }
  return sort_out(row_codes, centres, list_of);
}

DescriptorCodes make_codes_in_order(std::span<const float> values, const RunContext& context) {
  // 128 KB of codes stay in the second-level cache while all queries go over them.
  constexpr std::size_t kRowsAList = 2048;
  RowCodes row_codes = code_rows(values, context);
  const std::size_t count = row_codes.codes.size() / kCodeLength;
  DescriptorCodes result;
  if (count == 0) return result;
  for (std::size_t first = 0; first < count; first += kRowsAList) {
    result.list_start.push_back(static_cast<std::uint32_t>(first));
    const auto centre = code_at(row_codes.codes, first);  // one of its rows does: all are read
    result.centres.insert(result.centres.end(), centre.begin(), centre.end());
  }
  result.list_start.push_back(static_cast<std::uint32_t>(count));
  result.rows.resize(count);
  std::iota(result.rows.begin(), result.rows.end(), 0U);
  result.codes = std::move(row_codes.codes);
  result.tails = std::move(row_codes.tails);
  return result;
}

float dissimilarity_of_codes(std::int32_t squared_distance) {
  // One step of a code in units of the descriptors' own: sums are over rows in kRowSteps and
  // components of one length, the first's.
  static const float step = [] {
    const CodeBasis& basis = code_basis();
    float squared_length = 0.0F;
    for (std::size_t j = 0; j < kShotLength; ++j) {
      const auto element = static_cast<float>(basis.components[j]);
      squared_length += element * element;
    }
    return basis.step / (kRowSteps * std::sqrt(squared_length));
  }();
  return step * std::sqrt(0.5F * static_cast<float>(squared_distance));
}

std::string fault_of_codes(const DescriptorCodes& codes, std::size_t rows) {
  const std::size_t lists = codes.lists();
  if (codes.rows.size() != rows || codes.codes.size() != rows * kCodeLength ||
      (!codes.tails.empty() && codes.tails.size() != rows * kCodeLength) ||
      codes.centres.size() != lists * kCodeLength) {
    return "has search codes of " + std::to_string(codes.rows.size()) + " rows, " +
           std::to_string(codes.codes.size()) + " bytes and " + std::to_string(lists) +
           " lists for " + std::to_string(rows) + " descriptors";
  }
  if (rows == 0 ? lists != 0
                : lists == 0 || codes.list_start.front() != 0 || codes.list_start.back() != rows) {
    return "has search lists that do not hold its descriptors";
  }
  if (!std::is_sorted(codes.list_start.begin(), codes.list_start.end())) {
    return "has search lists that overlap";
  }
  std::vector<bool> seen(rows, false);
  for (const std::uint32_t row : codes.rows) {
    if (row >= rows || seen[row]) return "has search lists that do not name each descriptor once";
    seen[row] = true;
  }
  return {};
}

}  // namespace landmarkdb
