#include "bench/retrieval/calibration_measures.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace landmarkdb::bench {

double mean_log_loss(const Eigen::VectorXd& confidences, const Eigen::VectorXd& right) {
  constexpr double kLeastChance = 1e-12;
  if (right.size() == 0) return 0.0;
  double sum = 0.0;
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    const double chance = right[i] > 0.5 ? confidences[i] : 1.0 - confidences[i];
    sum -= std::log(std::max(chance, kLeastChance));
  }
  return sum / static_cast<double>(right.size());
}

// By ranks (Mann and Whitney 1947): O(N log N).
double area_under_roc(const Eigen::VectorXd& confidences, const Eigen::VectorXd& right) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(right.size()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return confidences[a] < confidences[b];
  });
  double pairs = 0.0;  // right above wrong
  double wrong_below = 0.0;
  for (std::size_t i = 0; i < order.size();) {
    double rights = 0.0;
    double wrongs = 0.0;
    const double tied = confidences[order[i]];
    for (; i < order.size() && confidences[order[i]] == tied; ++i) {
      (right[order[i]] > 0.5 ? rights : wrongs) += 1.0;
    }
    pairs += rights * (wrong_below + 0.5 * wrongs);
    wrong_below += wrongs;
  }
  const double all = right.sum() * wrong_below;
  return all > 0.0 ? pairs / all : 0.5;
}

Accepted accepted_at(double threshold,
                     const Eigen::VectorXd& confidences,
                     const Eigen::VectorXd& right) {
  Accepted accepted;
  accepted.threshold = threshold;
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    if (confidences[i] >= threshold) ++(right[i] > 0.5 ? accepted.right : accepted.wrong);
  }
  return accepted;
}

Interval wilson_interval(std::size_t successes, std::size_t count, double z) {
  if (count == 0) return {};
  const auto n = static_cast<double>(count);
  const double share = static_cast<double>(successes) / n;
  const double scale = 1.0 / (1.0 + z * z / n);
  const double middle = scale * (share + z * z / (2.0 * n));
  const double half = scale * z * std::sqrt(share * (1.0 - share) / n + z * z / (4.0 * n * n));
  // None and all of them have an end that is 0 or 1 exactly; rounding must not leave it beside.
  return {successes == 0 ? 0.0 : std::max(0.0, middle - half),
          successes == count ? 1.0 : std::min(1.0, middle + half)};
}

std::vector<ReliabilityBin> reliability(const Eigen::VectorXd& confidences,
                                        const Eigen::VectorXd& right,
                                        std::size_t bins) {
  std::vector<ReliabilityBin> table(bins);
  const auto count = static_cast<double>(bins);
  for (std::size_t i = 0; i < bins; ++i) {
    table[i].low = static_cast<double>(i) / count;
    table[i].high = static_cast<double>(i + 1) / count;
  }
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    const auto bin = static_cast<std::size_t>(std::floor(confidences[i] * count));
    ReliabilityBin& one = table[std::min(bin, bins - 1)];
    ++one.count;
    one.right += right[i] > 0.5 ? 1 : 0;
    one.mean_confidence += confidences[i];
  }
  for (ReliabilityBin& one : table) {
    if (one.count > 0) one.mean_confidence /= static_cast<double>(one.count);
    one.interval = wilson_interval(one.right, one.count);
  }
  return table;
}

}  // namespace landmarkdb::bench
