// landmarkdb-bench-mono: recognition and the calibration of its confidence on generated models.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/mono/calibrate.hpp"
#include "bench/mono/cases.hpp"
#include "bench/mono/feature_times.hpp"
#include "bench/mono/funnel.hpp"
#include "bench/mono/ready.hpp"
#include "cli/main_guard.hpp"
#include "engine/base/error.hpp"

namespace {

using namespace landmarkdb;
using namespace landmarkdb::bench;
using nlohmann::json;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
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
  app.add_option("--pictures", settings.pictures, "rendered pictures")->capture_default_str();
  app.add_option("--picture-models", settings.picture_models, "models in the pictures' catalogue")
      ->capture_default_str();
  app.add_subcommand("calibrate", "fit the weights of the confidence, and what edges say");
  app.add_subcommand("reliability", "the confidence of rendered pictures, and how many are right");
  app.add_subcommand("features", "time of the features of rendered pictures");
  app.add_subcommand("ready", "time and memory until `models` models are ready");
  app.add_subcommand("funnel", "which stage loses the known objects of rendered pictures");
  app.add_option(
      "--overlays", settings.overlays, "of `funnel`: pictures with their answers go there");
  return cli::run_main(argc, argv, app, [&] {
    json result;
    if (app.got_subcommand("recognition")) result["recognition"] = recognition_rows(settings);
    if (app.got_subcommand("calibrate")) result["calibration"] = calibrate(settings);
    if (app.got_subcommand("reliability")) result["reliability"] = reliability(settings);
    if (app.got_subcommand("features")) result["features"] = feature_times(settings);
    if (app.got_subcommand("ready")) result["ready"] = ready(settings);
    if (app.got_subcommand("funnel")) result["funnel"] = funnel(settings);
    if (!settings.json_file.empty()) {
      std::ofstream file(settings.json_file);
      file << result.dump(1) << "\n";
      if (!file) throw Error(ErrorCode::kUnavailable, settings.json_file + ": cannot be written");
    }
    return 0;
  });
}
