#pragma once

#include <Eigen/Core>

#include "bench/retrieval/calibration_samples.hpp"

namespace landmarkdb::bench {

struct LogisticOptions {
  double ridge = 0.1;  // half this times the squared weights is added to the loss; above zero
  double wrong_weight = 1.0;  // a wrong row counts as often as this
  int max_steps = 100;        // Newton's method takes some ten
};

// The weights of a logistic regression: those that minimise the log loss and the ridge, which holds
// for all columns but the first, the constant. `features` N x F, `right` N of 0 and 1.
//
// Newton's method (iteratively reweighted least squares; Hastie, Tibshirani, Friedman, The Elements
// of Statistical Learning, section 4.4.1), a step halved while it does not help. Throws
// Error{kInvalidArgument} when `right` has one class only or the steps do not come to rest.
// Cost: O(N F^2) a step. Thread-safe.
Eigen::VectorXd fit_logistic(const Eigen::MatrixXd& features,
                             const Eigen::VectorXd& right,
                             const LogisticOptions& options);

// The confidences, N in 0..1.
Eigen::VectorXd predict(const Eigen::MatrixXd& features, const Eigen::VectorXd& weights);

// Each row's confidence by the weights that were fitted to all rows of the other places. Throws as
// fit_logistic does, naming the place that was left out.
Eigen::VectorXd held_out_confidences(const Samples& samples, const LogisticOptions& options);

}  // namespace landmarkdb::bench
