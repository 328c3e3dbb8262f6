#include "bench/load/figures.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace landmarkdb::bench {

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return 0.0;
  const auto count = static_cast<double>(values.size());
  const double rank = std::clamp(std::ceil(p * count), 1.0, count);
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

LoadFigures load_figures(const std::vector<Request>& requests, double seconds) {
  LoadFigures figures;
  std::vector<double> times;
  for (const Request& request : requests) {
    switch (request.outcome) {
      case RequestOutcome::kAnswered:
        times.push_back(request.milliseconds);
        break;
      case RequestOutcome::kRefused:
        ++figures.refused;
        break;
      case RequestOutcome::kFailed:
        ++figures.failed;
        break;
    }
  }
  figures.answered = times.size();
  if (seconds > 0.0) figures.per_second = static_cast<double>(times.size()) / seconds;
  figures.p50_ms = quantile(times, 0.50);
  figures.p95_ms = quantile(times, 0.95);
  figures.p99_ms = quantile(std::move(times), 0.99);
  return figures;
}

double Fairness::p95_ratio() const {
  return alone.p95_ms > 0.0 ? beside_heavy.p95_ms / alone.p95_ms : 0.0;
}

double growth(const std::vector<double>& values) {
  if (values.size() < 2 || !(values.front() > 0.0)) return 0.0;
  return values.back() / values.front() - 1.0;
}

nlohmann::json to_json(const LoadFigures& figures) {
  return {{"answered", figures.answered},
          {"refused", figures.refused},
          {"failed", figures.failed},
          {"per_second", figures.per_second},
          {"p50_ms", figures.p50_ms},
          {"p95_ms", figures.p95_ms},
          {"p99_ms", figures.p99_ms}};
}

nlohmann::json to_json(const Fairness& fairness) {
  return {{"light_alone", to_json(fairness.alone)},
          {"light_beside_heavy", to_json(fairness.beside_heavy)},
          {"heavy", to_json(fairness.heavy)},
          {"light_p95_ratio", fairness.p95_ratio()}};
}

}  // namespace landmarkdb::bench
