// Fits the confidence of the verdict to what landmarkdb-bench-retrieval printed, and says how far
// it can be trusted in places it was not fitted to.

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "bench/retrieval/calibration.hpp"
#include "cli/write_file.hpp"
#include "engine/base/error.hpp"

namespace landmarkdb::bench {

namespace {

struct Settings {
  std::vector<std::string> files;
  std::vector<std::string> features;
  LogisticOptions logistic;
  std::string json;
  std::string plot;
};

int run(const Settings& settings) {
  std::vector<CsvTable> tables;
  for (const std::string& file : settings.files) tables.push_back(read_csv_file(file));
  const std::vector<Feature> features = choose_features(tables, settings.features);
  const Calibration result = calibrate(make_samples(tables, features), settings.logistic);
  std::printf("%s", calibration_text(result).c_str());
  if (!settings.json.empty()) cli::write_file(settings.json, calibration_json(result), "--json");
  if (!settings.plot.empty()) {
    cli::write_file(settings.plot, reliability_svg(result.reliability), "--plot");
  }
  return 0;
}

std::string features_help() {
  std::string text = "Fit these alone, a,b,c, of:";
  for (const Feature& feature : all_features()) text += " " + std::string(feature.name);
  return text +
         " (those from log_agreeing on only when named; contrast and log_contradicted where all "
         "files have "
         "them)";
}

}  // namespace

}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{"The confidence's weights from the output of landmarkdb-bench-retrieval"};
  app.add_option("files", settings.files, "CSV, each from a run with a seed of its own")
      ->required();
  app.add_option("--features", settings.features, landmarkdb::bench::features_help())
      ->delimiter(',')
      ->allow_extra_args(false);
  app.add_option("--wrong-weight", settings.logistic.wrong_weight, "A wrong row counts this often")
      ->check(CLI::Range(1e-3, 1e3));
  app.add_option(
         "--ridge", settings.logistic.ridge, "On the squares of all weights but the constant")
      ->check(CLI::Range(1e-6, 1e6));
  app.add_option("--json", settings.json, "Write all of it as JSON too");
  app.add_option("--plot", settings.plot, "Write the reliability diagram as SVG");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const landmarkdb::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return landmarkdb::exit_status(error.code());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
