#include "bench/retrieval/logistic.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Cholesky>

#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

// log(1 + e^z) without overflow.
double softplus(double z) { return std::max(z, 0.0) + std::log1p(std::exp(-std::abs(z))); }

double logistic(double z) {
  const double e = std::exp(-std::abs(z));
  return (z >= 0.0 ? 1.0 : e) / (1.0 + e);
}

struct Problem {
  const Eigen::MatrixXd& features;
  const Eigen::VectorXd& right;
  Eigen::VectorXd counts;  // how often each row counts
  Eigen::VectorXd ridge;   // of each weight
};

double loss(const Problem& problem, const Eigen::VectorXd& weights) {
  const Eigen::VectorXd z = problem.features * weights;
  double sum = 0.5 * problem.ridge.dot(weights.cwiseAbs2());
  for (Eigen::Index i = 0; i < z.size(); ++i) {
    sum += problem.counts[i] * (softplus(z[i]) - problem.right[i] * z[i]);
  }
  return sum;
}

// Newton's step from `weights`: the inverse of the Hessian times the negative gradient.
Eigen::VectorXd newton_step(const Problem& problem, const Eigen::VectorXd& weights) {
  const Eigen::VectorXd p = predict(problem.features, weights);
  const Eigen::VectorXd curvature = problem.counts.cwiseProduct(
      p.cwiseProduct(p.unaryExpr([](double one) { return 1.0 - one; })));
  Eigen::MatrixXd hessian =
      problem.features.transpose() * curvature.asDiagonal() * problem.features;
  hessian.diagonal() += problem.ridge;
  const Eigen::VectorXd slope =
      problem.features.transpose() * problem.counts.cwiseProduct(problem.right - p) -
      problem.ridge.cwiseProduct(weights);
  return hessian.ldlt().solve(slope);
}

}  // namespace

Eigen::VectorXd fit_logistic(const Eigen::MatrixXd& features,
                             const Eigen::VectorXd& right,
                             const LogisticOptions& options) {
  const double rights = right.sum();
  if (rights == 0.0 || rights == static_cast<double>(right.size())) {
    throw Error(ErrorCode::kInvalidArgument,
                std::string("all rows are ") + (rights == 0.0 ? "wrong" : "right") +
                    ", want right and wrong ones");
  }
  Problem problem{features, right, Eigen::VectorXd(right.size()), {}};
  for (Eigen::Index i = 0; i < right.size(); ++i) {
    problem.counts[i] = right[i] > 0.5 ? 1.0 : options.wrong_weight;
  }
  problem.ridge = Eigen::VectorXd::Constant(features.cols(), options.ridge);
  problem.ridge[0] = 0.0;
  constexpr double kAtRest = 1e-9;      // of the largest weight: more digits than are printed
  constexpr double kRounding = 1e-12;   // a loss this much higher is as low
  constexpr double kLeastShare = 1e-6;  // of a Newton step: below, the direction is rounding alone
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(features.cols());
  double now = loss(problem, weights);
  for (int i = 0; i < options.max_steps; ++i) {
    const Eigen::VectorXd step = newton_step(problem, weights);
    double share = 1.0;
    double next = loss(problem, weights + step);
    while (!(next <= now + kRounding * std::abs(now)) && share > kLeastShare) {
      share *= 0.5;
      next = loss(problem, weights + share * step);
    }
    if (!std::isfinite(next)) break;
    weights += share * step;
    now = next;
    if (step.cwiseAbs().maxCoeff() <= kAtRest * (1.0 + weights.cwiseAbs().maxCoeff())) {
      return weights;
    }
  }
  throw Error(ErrorCode::kInvalidArgument,
              "the weights do not come to rest in " + std::to_string(options.max_steps) +
                  " steps, want fewer features, more rows or a larger ridge");
}

Eigen::VectorXd predict(const Eigen::MatrixXd& features, const Eigen::VectorXd& weights) {
  return (features * weights).unaryExpr(&logistic);
}

Eigen::VectorXd held_out_confidences(const Samples& samples, const LogisticOptions& options) {
  Eigen::VectorXd confidences(samples.right.size());
  for (std::size_t place = 0; place < samples.place_names.size(); ++place) {
    std::vector<Eigen::Index> inside;
    std::vector<Eigen::Index> outside;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      (samples.places[i] == place ? inside : outside).push_back(static_cast<Eigen::Index>(i));
    }
    try {
      const Eigen::VectorXd weights =
          fit_logistic(samples.features(outside, Eigen::all), samples.right(outside), options);
      confidences(inside) = predict(samples.features(inside, Eigen::all), weights);
    } catch (const Error& error) {
      throw Error(error.code(), "without " + samples.place_names[place] + ": " + error.what());
    }
  }
  return confidences;
}

}  // namespace landmarkdb::bench
