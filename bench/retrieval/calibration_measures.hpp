#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace landmarkdb::bench {

// All of these take confidences in 0..1 and, as long, `right` of 0 and 1.

// Mean of -log of the confidence in what was the case, in nats. No row costs more than a confidence
// of 1e-12 in it does.
double mean_log_loss(const Eigen::VectorXd& confidences, const Eigen::VectorXd& right);

// The chance that a right row has more confidence than a wrong one; equal ones count half. 0.5 when
// one of the classes is empty.
double area_under_roc(const Eigen::VectorXd& confidences, const Eigen::VectorXd& right);

// Rows with at least this confidence.
struct Accepted {
  double threshold = 0.0;
  std::size_t right = 0;
  std::size_t wrong = 0;
};
Accepted accepted_at(double threshold,
                     const Eigen::VectorXd& confidences,
                     const Eigen::VectorXd& right);

struct Interval {
  double low = 0.0;
  double high = 1.0;
};

constexpr double kNinetyPercent = 1.6448536269514722;  // the normal quantile of 0.95

// Where the chance of a success lies, given `successes` of `count` (Wilson 1927), two-sided, at the
// normal quantile `z`. 0..1 when nothing was counted.
Interval wilson_interval(std::size_t successes, std::size_t count, double z = kNinetyPercent);

// Rows whose confidence lies in [low, high), the last bin's high included.
struct ReliabilityBin {
  double low = 0.0;
  double high = 0.0;
  std::size_t count = 0;
  std::size_t right = 0;
  double mean_confidence = 0.0;  // 0 when empty
  Interval interval;             // 90 % of the share right

  double share_right() const {
    return count == 0 ? 0.0 : static_cast<double>(right) / static_cast<double>(count);
  }
};
std::vector<ReliabilityBin> reliability(const Eigen::VectorXd& confidences,
                                        const Eigen::VectorXd& right,
                                        std::size_t bins = 10);

}  // namespace landmarkdb::bench
