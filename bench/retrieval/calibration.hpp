#pragma once

#include <string>
#include <vector>

#include "bench/retrieval/calibration_measures.hpp"
#include "bench/retrieval/calibration_samples.hpp"
#include "bench/retrieval/logistic.hpp"

namespace landmarkdb::bench {

// Weights of the confidence, and how well weights made alike do in places they were not fitted to.
struct Calibration {
  LogisticOptions options;
  std::vector<std::string> names;  // of the weights; the first is the constant
  Eigen::VectorXd weights;         // fitted to all rows
  std::size_t places = 0;
  std::size_t right = 0;         // queries whose best pose is right
  std::size_t wrong = 0;         // and wrong
  std::size_t without_pose = 0;  // and those that have none

  // Of the confidences with the row's own place left out of the fit:
  double log_loss = 0.0;  // nats
  double area_under_roc = 0.5;
  std::vector<Accepted> accepted;           // at 0.5, 0.7, 0.8, 0.9
  std::vector<ReliabilityBin> reliability;  // ten

  std::size_t queries() const { return right + wrong + without_pose; }
};

// Throws as fit_logistic and held_out_confidences do. Cost: a fit a place.
Calibration calibrate(const Samples& samples, const LogisticOptions& options);

// All of it for people, the weights as rows of a C++ table; and as JSON.
std::string calibration_text(const Calibration& calibration);
std::string calibration_json(const Calibration& calibration);

// The reliability diagram as SVG, dark on white: share right over mean confidence with 90 %
// intervals, and the counts below. The same bins give the same bytes.
std::string reliability_svg(const std::vector<ReliabilityBin>& bins);

}  // namespace landmarkdb::bench
