// landmarkdb-bench-mono: recognition and the calibration of its confidence on generated models.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "bench/mono/recognition.hpp"
#include "bench/retrieval/logistic.hpp"
#include "cli/main_guard.hpp"
#include "engine/base/error.hpp"

namespace {

using namespace landmarkdb;
using namespace landmarkdb::bench;
using nlohmann::json;

struct Settings {
  std::size_t scenes = 300, models = 100;
  std::uint64_t seed = 10000;
  std::string json_file;
  bool cpu_time = false;
  std::string only;  // rows whose name has this in it
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

struct Case {
  const char* name;
  SceneKind kind;
  std::size_t types;
  std::size_t features;
  double clutter;
  bool links, directions, edges;
};

constexpr Case kCases[] = {
    {"3 types, 60 features, links", SceneKind::kKnown, 3, 60, -1.0, true, false, false},
    {"the same, edge directions", SceneKind::kKnown, 3, 60, -1.0, true, true, false},
    {"the same, directions and edges", SceneKind::kKnown, 3, 60, -1.0, true, true, true},
    {"3 types, clutter 50 %, no links", SceneKind::kKnown, 3, 60, 0.5, false, false, false},
    {"3 types, 100 features, links", SceneKind::kKnown, 3, 100, -1.0, true, false, false},
    {"1 type, 60 features, links, directions", SceneKind::kKnown, 1, 60, -1.0, true, true, false},
    {"unknown object, 60 features, links", SceneKind::kUnknown, 3, 60, -1.0, true, false, false},
    {"unknown object, directions and edges", SceneKind::kUnknown, 3, 60, -1.0, true, true, true},
    {"mirror image of a known object", SceneKind::kMirrored, 3, 60, -1.0, true, false, false},
    {"mirror image, directions and edges", SceneKind::kMirrored, 3, 60, -1.0, true, true, true},
    {"clutter alone, 60 features, links", SceneKind::kClutter, 3, 60, -1.0, true, false, false},
    {"unknown object, 400 features, 1 type", SceneKind::kUnknown, 1, 400, -1.0, true, true, false},
};

RecognitionOptions options_of(const Case& one, const Settings& settings, std::uint64_t seed) {
  RecognitionOptions options;
  options.models = settings.models;
  options.scenes = settings.scenes;
  options.seed = seed;
  options.kind = one.kind;
  options.cpu_time = settings.cpu_time;
  options.model.types = one.types;
  options.scene.features = one.features;
  options.scene.clutter_share = one.clutter;
  options.scene.links = one.links;
  options.scene.directions = one.directions;
  options.scene.edges = one.edges;
  return options;
}

json recognition_rows(const Settings& settings) {
  json rows = json::array();
  std::printf("%-40s %5s %6s %6s %6s %6s | %6s %6s %7s %7s %8s\n",
              "scenes",
              "4-5",
              "6-7",
              "8-10",
              "11+",
              "8+",
              "acc 8+",
              "wrong",
              "med ms",
              "p95 ms",
              "med mm");
  for (const Case& one : kCases) {
    if (std::string(one.name).find(settings.only) == std::string::npos) continue;
    const std::vector<Outcome> outcomes = run_recognition(options_of(one, settings, settings.seed));
    struct Group {
      std::size_t least, most, n = 0, right = 0, accepted = 0;
    };
    std::vector<Group> groups{{4, 5}, {6, 7}, {8, 10}, {11, 999}, {8, 999}};
    std::vector<double> ms, mm;
    std::size_t wrong = 0;
    for (const Outcome& o : outcomes) {
      ms.push_back(o.ms);
      wrong += o.accepted && !o.right ? 1 : 0;
      if (o.right && o.accepted) mm.push_back(o.shift_mm);
      for (Group& g : groups) {
        if (o.true_features < g.least || o.true_features > g.most) continue;
        ++g.n;
        g.right += o.right ? 1 : 0;
        g.accepted += o.right && o.accepted ? 1 : 0;
      }
    }
    const auto share = [](std::size_t part, std::size_t n) {
      return n == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(n);
    };
    json row{{"scenes", one.name},
             {"n", outcomes.size()},
             {"wrong_accepted_percent", share(wrong, outcomes.size())},
             {"ms_median", quantile(ms, 0.5)},
             {"ms_p95", quantile(ms, 0.95)},
             {"ms_worst", quantile(ms, 1.0)},
             {"shift_median_mm", quantile(mm, 0.5)},
             {"right_percent", json::object()}};
    for (const Group& g : groups) {
      row["right_percent"][std::to_string(g.least) + "-" + std::to_string(g.most)] =
          json{{"n", g.n}, {"right", share(g.right, g.n)}, {"accepted", share(g.accepted, g.n)}};
    }
    if (one.kind == SceneKind::kKnown) {
      std::printf("%-40s %5.0f %6.1f %6.1f %6.1f %6.1f | %6.1f",
                  one.name,
                  share(groups[0].right, groups[0].n),
                  share(groups[1].right, groups[1].n),
                  share(groups[2].right, groups[2].n),
                  share(groups[3].right, groups[3].n),
                  share(groups[4].right, groups[4].n),
                  share(groups[4].accepted, groups[4].n));
    } else {
      std::printf("%-40s %5s %6s %6s %6s %6s | %6s", one.name, "-", "-", "-", "-", "-", "-");
    }
    std::printf(" %5.2f%% %7.2f %7.2f %8.2f\n",
                share(wrong, outcomes.size()),
                quantile(ms, 0.5),
                quantile(ms, 0.95),
                quantile(mm, 0.5));
    std::fflush(stdout);
    rows.push_back(row);
  }
  return rows;
}

// Fits the weights on scenes of their own seeds, and says how the confidence stands on others.
json calibrate(const Settings& settings) {
  std::vector<Outcome> fit;
  std::uint64_t seed = 1;
  for (const Case& one : kCases) {
    if (one.features > 100) continue;
    for (const Outcome& o : run_recognition(options_of(one, settings, seed++))) {
      if (o.told) fit.push_back(o);
    }
  }
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(fit.size()),
                        static_cast<Eigen::Index>(kConfidenceTerms));
  Eigen::VectorXd right(static_cast<Eigen::Index>(fit.size()));
  for (std::size_t i = 0; i < fit.size(); ++i) {
    const auto row = confidence_terms(fit[i].evidence);
    for (std::size_t k = 0; k < kConfidenceTerms; ++k)
      terms(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) = row[k];
    right(static_cast<Eigen::Index>(i)) = fit[i].right ? 1.0 : 0.0;
  }
  const Eigen::VectorXd weights = fit_logistic(terms, right, {.ridge = 1.0});
  json result{{"rows", fit.size()},
              {"right", right.sum()},
              {"weights", std::vector<double>(weights.data(), weights.data() + weights.size())}};
  std::printf("%zu hypotheses, %.0f right; weights", fit.size(), right.sum());
  for (const double w : weights) std::printf(" %.4f,", w);
  std::printf("\n");
  const Eigen::VectorXd confidence = predict(terms, weights);
  for (int bin = 0; bin < 10; ++bin) {
    double n = 0.0, hits = 0.0, sum = 0.0;
    for (Eigen::Index i = 0; i < confidence.size(); ++i) {
      if (std::min(9, static_cast<int>(confidence(i) * 10.0)) != bin) continue;
      n += 1.0;
      hits += right(i);
      sum += confidence(i);
    }
    if (n > 0.0) std::printf("confidence %.2f: %4.0f answers, right %.2f\n", sum / n, n, hits / n);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Recognition of models in single images, on generated scenes from a seed."};
  app.require_subcommand(1);
  app.add_option("--seed", settings.seed, "seed; nothing is tuned on those from 10000 on")
      ->capture_default_str();
  app.add_option("--models", settings.models, "models in the catalogue")->capture_default_str();
  app.add_option("--scenes", settings.scenes, "scenes a row")->capture_default_str();
  app.add_option("--only", settings.only, "rows of `recognition` whose name has this in it");
  app.add_flag(
      "--cpu-time", settings.cpu_time, "times of `recognition` are the thread's, not the clock's");
  app.add_option("--json", settings.json_file, "write the figures to FILE");
  app.add_subcommand("recognition", "right, accepted and wrong answers by what is in the image");
  app.add_subcommand("calibrate", "fit the weights of the confidence");
  return cli::run_main(argc, argv, app, [&] {
    json result;
    if (app.got_subcommand("recognition")) result["recognition"] = recognition_rows(settings);
    if (app.got_subcommand("calibrate")) result["calibration"] = calibrate(settings);
    if (!settings.json_file.empty()) {
      std::ofstream file(settings.json_file);
      file << result.dump(1) << "\n";
      if (!file) throw Error(ErrorCode::kUnavailable, settings.json_file + ": cannot be written");
    }
    return 0;
  });
}
