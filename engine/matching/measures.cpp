#include "engine/matching/measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "engine/base/error.hpp"
#include "engine/matching/lanes.hpp"

namespace landmarkdb {
namespace {

void check_same_length(std::span<const float> a, std::span<const float> b) {
  if (a.size() != b.size()) {
    throw Error(ErrorCode::kInvalidArgument,
                "histograms have " + std::to_string(a.size()) + " and " + std::to_string(b.size()) +
                    " bins, want as many each");
  }
}

// Table 1 on normalised histograms. For the Euclidean ones a product of unit vectors would do as
// well, but loses the small distances to cancellation.
double value_of_normalised(Measure which, std::span<const float> a, std::span<const float> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double x = static_cast<double>(a[i]);
    const double y = static_cast<double>(b[i]);
    switch (which) {
      case Measure::kL2:
      case Measure::kCorrelation:
      case Measure::kBhattacharyya:
        sum += (x - y) * (x - y);
        break;
      case Measure::kChi2:
        if (x + y > 0.0) sum += (x - y) * (x - y) / (x + y);
        break;
      case Measure::kIntersection:
        sum += std::min(x, y);
        break;
      case Measure::kL1:
        sum += std::abs(x - y);
        break;
    }
  }
  switch (which) {
    case Measure::kL2:
    case Measure::kBhattacharyya:
      return std::sqrt(sum / 2.0);
    case Measure::kCorrelation:
      return 1.0 - sum / 2.0;
    case Measure::kL1:
      return sum / 2.0;
    case Measure::kChi2:
    case Measure::kIntersection:
      break;
  }
  return sum;
}

}  // namespace

bool is_euclidean(Measure which) {
  return which == Measure::kL2 || which == Measure::kCorrelation ||
         which == Measure::kBhattacharyya;
}

void normalise_histogram(Measure which, std::span<const float> histogram, std::span<float> out) {
  check_same_length(histogram, out);
  const bool to_unit_length = which == Measure::kL2 || which == Measure::kCorrelation;
  double mean = 0.0;
  if (which == Measure::kCorrelation && !histogram.empty()) {
    for (const float v : histogram) mean += static_cast<double>(v);
    mean /= static_cast<double>(histogram.size());
  }
  double size = 0.0;
  for (const float v : histogram) {
    const double x = static_cast<double>(v) - mean;
    size += to_unit_length ? x * x : x;
  }
  if (to_unit_length) size = std::sqrt(size);
  // What is left of equal bins after taking off their mean is rounding, not content.
  constexpr double kRounding = 1e-12;
  const bool has_content =
      size > kRounding * std::abs(mean) * static_cast<double>(histogram.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double x = has_content ? (static_cast<double>(histogram[i]) - mean) / size : 0.0;
    out[i] = static_cast<float>(which == Measure::kBhattacharyya ? std::sqrt(x) : x);
  }
}

double measure(Measure which, std::span<const float> a, std::span<const float> b) {
  check_same_length(a, b);
  std::vector<float> normal_a(a.size());
  std::vector<float> normal_b(b.size());
  normalise_histogram(which, a, normal_a);
  normalise_histogram(which, b, normal_b);
  return value_of_normalised(which, normal_a, normal_b);
}

float dissimilarity(Measure which, std::span<const float> a, std::span<const float> b) {
  check_same_length(a, b);
  std::vector<float> normal_a(a.size());
  std::vector<float> normal_b(b.size());
  normalise_histogram(which, a, normal_a);
  normalise_histogram(which, b, normal_b);
  return normalised_dissimilarity(which, normal_a, normal_b);
}

double measure_of_dissimilarity(Measure which, double dissimilarity) {
  const bool falls = which == Measure::kCorrelation || which == Measure::kIntersection;
  return falls ? 1.0 - dissimilarity : dissimilarity;
}

float normalised_dissimilarity(Measure which, std::span<const float> a, std::span<const float> b) {
  const LaneKernels& kernels = lane_kernels();
  switch (which) {
    case Measure::kL2:
    case Measure::kBhattacharyya:
      return std::sqrt(0.5F * kernels.squared_l2(a.data(), b.data(), a.size()));
    case Measure::kCorrelation:
      return 0.5F * kernels.squared_l2(a.data(), b.data(), a.size());
    case Measure::kL1:
      return 0.5F * kernels.l1(a.data(), b.data(), a.size());
    case Measure::kChi2:
      return kernels.chi2(a.data(), b.data(), a.size());
    case Measure::kIntersection:
      return std::max(0.0F, 1.0F - kernels.intersection(a.data(), b.data(), a.size()));
  }
  throw Error(ErrorCode::kInvalidArgument,
              "measure " + std::to_string(static_cast<int>(which)) + " is none of the six");
}

}  // namespace landmarkdb
