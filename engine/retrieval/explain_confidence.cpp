#include <algorithm>
#include <cmath>

#include "engine/retrieval/confidence.hpp"
#include "engine/retrieval/explain.hpp"

namespace landmarkdb {

namespace {

// Beyond this the confidence is 0 or 1 to the last digit anyone reads, and its log-odds mean
// nothing.
constexpr double kLeastDoubt = 1e-12;

constexpr double kManyAgreeing = 200.0;  // keypoints: 19 of 20 right poses have fewer

double log_odds(double confidence) {
  const double c = std::clamp(confidence, kLeastDoubt, 1.0 - kLeastDoubt);
  return std::log(c / (1.0 - c));
}

}  // namespace

std::vector<ConfidenceTerm> confidence_terms(const Evidence& evidence,
                                             double quality,
                                             double margin) {
  const double now = log_odds(confidence_of(evidence, quality, margin));
  std::vector<ConfidenceTerm> terms;
  const auto add =
      [&](const char* name, double value, double worst, double ideal, const auto& confidence_with) {
        const double lowest = log_odds(confidence_with(worst));
        const double highest = log_odds(confidence_with(ideal));
        terms.push_back(
            {name, value, ideal, std::max(0.0, now - lowest), std::max(0.0, highest - now)});
      };
  const auto add_evidence =
      [&](const char* name, double Evidence::*figure, double worst, double ideal) {
        add(name, evidence.*figure, worst, ideal, [&](double value) {
          Evidence other = evidence;
          other.*figure = value;
          return confidence_of(other, quality, margin);
        });
      };
  add("margin", margin, 0.0, 1.0, [&](double value) {
    return confidence_of(evidence, quality, value);
  });
  add("quality", quality, 0.0, 1.0, [&](double value) {
    return confidence_of(evidence, value, margin);
  });
  add_evidence("overlap", &Evidence::overlap, 0.0, 1.0);
  add_evidence("explained", &Evidence::explained, 0.0, 1.0);
  add_evidence("free_space_violation", &Evidence::crossed, 1.0, 0.0);
  add_evidence("coverage", &Evidence::coverage, 0.0, 1.0);
  add_evidence("observability", &Evidence::observability, 0.0, 1.0);
  add_evidence("contrast", &Evidence::contrast, 0.0, 1.0);
  add_evidence("contradicted", &Evidence::contradicted, 1.0, 0.0);
  add_evidence("refuted", &Evidence::refuted, 1.0, 0.0);
  add_evidence("agreeing", &Evidence::agreeing, 0.0, kManyAgreeing);
  add_evidence("outgrown", &Evidence::outgrown, 1.0, 0.0);
  std::stable_sort(
      terms.begin(), terms.end(), [](const auto& a, const auto& b) { return a.cost > b.cost; });
  return terms;
}

}  // namespace landmarkdb
