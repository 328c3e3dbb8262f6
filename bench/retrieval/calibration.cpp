#include "bench/retrieval/calibration.hpp"

#include <algorithm>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace landmarkdb::bench {

namespace {

constexpr double kThresholds[] = {0.5, 0.7, 0.8, 0.9};

template <typename... Values>
std::string print(const char* format, Values... values) {
  char text[300];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double wrong_share(const Calibration& calibration, const Accepted& accepted) {
  return static_cast<double>(accepted.wrong) / static_cast<double>(calibration.queries());
}

std::string thresholds_text(const Calibration& calibration) {
  std::string text = "threshold  right accepted   wrong accepted   wrong of all queries\n";
  for (const Accepted& one : calibration.accepted) {
    text += print("%9.2f  %5zu of %-5zu   %5zu of %-5zu   %6.2f %%\n",
                  one.threshold,
                  one.right,
                  calibration.right,
                  one.wrong,
                  calibration.wrong,
                  100.0 * wrong_share(calibration, one));
  }
  return text;
}

std::string reliability_text(const Calibration& calibration) {
  std::string text = "confidence  queries   mean  share right  90 % interval\n";
  for (const ReliabilityBin& bin : calibration.reliability) {
    const std::string range = print("%.1f - %.1f", bin.low, bin.high);
    text += print("%-10s  %7zu", range.c_str(), bin.count);
    if (bin.count > 0) {
      text += print("  %.3f        %.3f  %.3f - %.3f",
                    bin.mean_confidence,
                    bin.share_right(),
                    bin.interval.low,
                    bin.interval.high);
    }
    text += "\n";
  }
  return text;
}

std::string weights_text(const Calibration& calibration) {
  std::string text;
  for (std::size_t i = 0; i < calibration.names.size(); ++i) {
    text += print("    {\"%s\", %.4f},",
                  calibration.names[i].c_str(),
                  calibration.weights[static_cast<Eigen::Index>(i)]);
    for (const Feature& feature : all_features()) {
      if (feature.name != calibration.names[i] || feature.formula == feature.name) continue;
      text += "  // " + std::string(feature.formula);
    }
    text += "\n";
  }
  return text;
}

nlohmann::ordered_json held_out_json(const Calibration& calibration) {
  nlohmann::ordered_json out = {{"log_loss", calibration.log_loss},
                                {"area_under_roc", calibration.area_under_roc}};
  for (const Accepted& one : calibration.accepted) {
    out["accepted"].push_back({{"threshold", one.threshold},
                               {"right", one.right},
                               {"wrong", one.wrong},
                               {"wrong_share_of_queries", wrong_share(calibration, one)}});
  }
  for (const ReliabilityBin& bin : calibration.reliability) {
    nlohmann::ordered_json one = {
        {"low", bin.low}, {"high", bin.high}, {"queries", bin.count}, {"right", bin.right}};
    if (bin.count > 0) {
      one["mean_confidence"] = bin.mean_confidence;
      one["share_right"] = bin.share_right();
      one["interval_90"] = {bin.interval.low, bin.interval.high};
    }
    out["reliability"].push_back(std::move(one));
  }
  return out;
}

}  // namespace

Calibration calibrate(const Samples& samples, const LogisticOptions& options) {
  Calibration result;
  result.options = options;
  result.names = samples.names;
  result.weights = fit_logistic(samples.features, samples.right, options);
  result.places = samples.place_names.size();
  result.right = static_cast<std::size_t>(samples.right.sum());
  result.wrong = samples.size() - result.right;
  result.without_pose = samples.without_pose;
  const Eigen::VectorXd confidences = held_out_confidences(samples, options);
  result.log_loss = mean_log_loss(confidences, samples.right);
  result.area_under_roc = area_under_roc(confidences, samples.right);
  for (const double threshold : kThresholds) {
    result.accepted.push_back(accepted_at(threshold, confidences, samples.right));
  }
  result.reliability = reliability(confidences, samples.right);
  return result;
}

std::string calibration_text(const Calibration& calibration) {
  return print("%zu queries in %zu places: best pose right %zu, wrong %zu, no pose %zu\n",
               calibration.queries(),
               calibration.places,
               calibration.right,
               calibration.wrong,
               calibration.without_pose) +
         print("each place by weights from the others: log loss %.4f, area under the ROC %.4f\n\n",
               calibration.log_loss,
               calibration.area_under_roc) +
         thresholds_text(calibration) + "\n" + reliability_text(calibration) + "\n" +
         print("weights from all places, ridge %g, a wrong row counts %g times:\n",
               calibration.options.ridge,
               calibration.options.wrong_weight) +
         weights_text(calibration);
}

std::string calibration_json(const Calibration& calibration) {
  nlohmann::ordered_json out = {{"queries", calibration.queries()},
                                {"places", calibration.places},
                                {"right", calibration.right},
                                {"wrong", calibration.wrong},
                                {"without_pose", calibration.without_pose},
                                {"ridge", calibration.options.ridge},
                                {"wrong_weight", calibration.options.wrong_weight}};
  for (std::size_t i = 0; i < calibration.names.size(); ++i) {
    out["weights"].push_back({{"name", calibration.names[i]},
                              {"weight", calibration.weights[static_cast<Eigen::Index>(i)]}});
  }
  out["held_out"] = held_out_json(calibration);
  return out.dump(2) + "\n";
}

}  // namespace landmarkdb::bench
