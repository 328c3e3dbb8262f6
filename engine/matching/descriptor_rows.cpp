#include "engine/matching/descriptor_rows.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "engine/base/error.hpp"
#include "engine/matching/measures.hpp"

namespace landmarkdb {

std::vector<float> normalise_rows(std::span<const float> values,
                                  Measure measure,
                                  std::string_view name) {
  if (values.size() % kShotLength != 0) {
    throw Error(ErrorCode::kInvalidArgument,
                std::string(name) + " have " + std::to_string(values.size()) +
                    " numbers, want a multiple of " + std::to_string(kShotLength));
  }
  const std::size_t rows = values.size() / kShotLength;
  if (rows >= std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::kInvalidArgument,
                std::string(name) + " are " + std::to_string(rows) + ", want fewer than 2^32 - 1");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || values[i] < 0.0F) {
      throw Error(ErrorCode::kInvalidArgument,
                  std::string(name) + ": row " + std::to_string(i / kShotLength) + " holds " +
                      std::to_string(values[i]) + ", want numbers of at least 0");
    }
  }
  std::vector<float> normalised(values.size());
  for (std::size_t row = 0; row < rows; ++row) {
    normalise_histogram(measure,
                        descriptor_row(values, row),
                        std::span(normalised).subspan(row * kShotLength, kShotLength));
  }
  return normalised;
}

}  // namespace landmarkdb
