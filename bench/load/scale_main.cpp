// What many places cost: the same frames against databases of more and more of them.

#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/load/figures.hpp"
#include "bench/load/server_process.hpp"
#include "bench/load/site.hpp"
#include "bench/retrieval/pose_errors.hpp"
#include "cli/write_file.hpp"
#include "client/client.hpp"

namespace landmarkdb::bench {
namespace {

// Frames are taken in the first of the places, so that each size is asked the same.
constexpr std::size_t kAskedPlaces = 10;

struct Settings {
  std::vector<std::size_t> sizes = {10, 100};
  SiteOptions site;
  std::size_t frames = 20;
  std::size_t strangers = 0;  // frames of places that are in no database
  std::string folder;         // databases are kept here; empty: not kept
  double most_seconds = 3600.0;
  int threads = 0;
  std::string json;
};

struct Row {
  std::size_t places = 0, localized = 0, right_place = 0, right_pose = 0, ambiguous = 0;
  std::size_t strangers = 0, strangers_localized = 0;
  std::uint64_t keypoints = 0, database_bytes = 0, resident_bytes = 0, peak_bytes = 0;
  double ready_s = 0.0;
  std::vector<double> total_ms, match_ms, pose_ms, other_ms;
};

using Milliseconds = std::chrono::duration<double, std::milli>;

// Frames of as many places as there are frames, with seeds beyond those of any database.
std::vector<SiteFrame> take_strange_frames(const Settings& settings, const RunContext& context) {
  if (settings.strangers == 0) return {};
  constexpr std::uint64_t kBeyond = 40'000;
  SiteOptions elsewhere = settings.site;
  elsewhere.seed += kBeyond;
  return take_frames(elsewhere, settings.strangers, settings.strangers, 0, context);
}

void ask_stranger(client::Client& client, const SiteFrame& frame, Row& row) {
  const std::vector<QueryCloud> question{{frame.cloud}};
  ++row.strangers;
  if (client.query(question, {}, {}).status == QueryStatus::kLocalized) ++row.strangers_localized;
}

void ask(client::Client& client, const SiteFrame& frame, Row& row) {
  const auto sent = std::chrono::steady_clock::now();
  const std::vector<QueryCloud> question{{frame.cloud}};
  const QueryResult answer = client.query(question, {}, {});
  row.total_ms.push_back(Milliseconds(std::chrono::steady_clock::now() - sent).count());
  row.match_ms.push_back(Milliseconds(answer.timings.match).count());
  row.pose_ms.push_back(Milliseconds(answer.timings.pose).count());
  row.other_ms.push_back(row.total_ms.back() - row.match_ms.back() - row.pose_ms.back());
  if (answer.status == QueryStatus::kAmbiguous) ++row.ambiguous;
  if (answer.status != QueryStatus::kLocalized) return;
  ++row.localized;
  const Hypothesis& best = answer.hypotheses.at(0);
  if (best.scene != frame.place) return;
  ++row.right_place;
  Eigen::Isometry3d estimate;
  estimate.matrix() = best.T_scene_sensor;
  if (pose_error(frame.T_scene_camera, estimate).right()) ++row.right_pose;
}

Row measure(const std::string& db,
            std::size_t places,
            const std::vector<SiteFrame>& frames,
            const std::vector<SiteFrame>& strangers,
            int threads) {
  Row row;
  row.places = places;
  const ServerProcess server(db, threads);
  row.ready_s = server.seconds_until_ready();
  client::Client client({.server = server.address()}, {});
  const client::Stats ready = client.stats({});
  row.keypoints = ready.keypoints;
  row.database_bytes = ready.database_bytes;
  for (const SiteFrame& frame : frames) ask(client, frame, row);
  row.resident_bytes = client.stats({}).resident_bytes;
  row.peak_bytes = server.peak_resident_bytes();
  for (const SiteFrame& frame : strangers) ask_stranger(client, frame, row);
  return row;
}

nlohmann::json to_json(const Row& row) {
  return {{"places", row.places},
          {"keypoints", row.keypoints},
          {"frames", row.total_ms.size()},
          {"localized", row.localized},
          {"right_place", row.right_place},
          {"right_pose", row.right_pose},
          {"ambiguous", row.ambiguous},
          {"strangers", row.strangers},
          {"strangers_localized", row.strangers_localized},
          {"median_ms", quantile(row.total_ms, 0.5)},
          {"p95_ms", quantile(row.total_ms, 0.95)},
          {"match_ms", quantile(row.match_ms, 0.5)},
          {"pose_ms", quantile(row.pose_ms, 0.5)},
          {"other_ms", quantile(row.other_ms, 0.5)},
          {"ready_s", row.ready_s},
          {"resident_bytes", row.resident_bytes},
          {"peak_bytes", row.peak_bytes},
          {"database_bytes", row.database_bytes}};
}

void print_header() {
  std::printf(
      "| places | keypoints | median ms | p95 ms | match | pose | other | localized | right place "
      "| "
      "right pose | strangers localized | ready s | resident MB | peak MB | database MB |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- "
      "|\n");
}

void print_row(const Row& row) {
  constexpr double kMega = 1e6;
  std::printf(
      "| %zu | %llu | %.0f | %.0f | %.0f | %.0f | %.0f | %zu of %zu | %zu | %zu | %zu of %zu | "
      "%.2f | %.0f | "
      "%.0f | %.0f |\n",
      row.places,
      static_cast<unsigned long long>(row.keypoints),
      quantile(row.total_ms, 0.5),
      quantile(row.total_ms, 0.95),
      quantile(row.match_ms, 0.5),
      quantile(row.pose_ms, 0.5),
      quantile(row.other_ms, 0.5),
      row.localized,
      row.total_ms.size(),
      row.right_place,
      row.right_pose,
      row.strangers_localized,
      row.strangers,
      row.ready_s,
      static_cast<double>(row.resident_bytes) / kMega,
      static_cast<double>(row.peak_bytes) / kMega,
      static_cast<double>(row.database_bytes) / kMega);
  std::fflush(stdout);
}

int run(const Settings& settings) {
  RunContext context;
  context.threads = 2;
  const testing::TempFolder temporary;
  const std::string folder = settings.folder.empty() ? temporary.path() : settings.folder;
  const auto file_of = [&](std::size_t places) {
    return folder + "/places-" + std::to_string(places) + ".db";
  };
  for (const std::size_t places : settings.sizes) {
    const std::string db = file_of(places);
    if (fill_database(db, settings.site, places, settings.most_seconds, context) == places)
      continue;
    std::fprintf(stderr, "%s is not complete yet; run again\n", db.c_str());
    return 1;
  }
  const std::vector<SiteFrame> frames =
      take_frames(settings.site, kAskedPlaces, settings.frames, 0, context);
  const std::vector<SiteFrame> strangers = take_strange_frames(settings, context);
  nlohmann::json rows = nlohmann::json::array();
  print_header();
  for (const std::size_t places : settings.sizes) {
    const Row row = measure(file_of(places), places, frames, strangers, settings.threads);
    print_row(row);
    rows.push_back(to_json(row));
  }
  if (settings.json.empty()) return 0;
  const nlohmann::json all{{"seed", settings.site.seed},
                           {"place_points", settings.site.points},
                           {"place_size", settings.site.size},
                           {"rows", rows}};
  cli::write_file(settings.json, all.dump(1) + "\n", "--json");
  return 0;
}

}  // namespace
}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{
      "The same depth frames against databases of more and more generated places: time, right "
      "answers, memory, size, time until ready"};
  app.add_option("--places", settings.sizes, "Sizes, one after another")
      ->capture_default_str()
      ->check(CLI::Range(10, 9999));
  app.add_option("--points", settings.site.points, "Scanned points a place")->capture_default_str();
  app.add_option("--size", settings.site.size, "Of a place, against the usual")
      ->capture_default_str()
      ->check(CLI::Range(0.3, 3.0));
  app.add_option("--frames", settings.frames, "Frames, of the first ten places in turn")
      ->capture_default_str()
      ->check(CLI::Range(1, 10'000));
  app.add_option("--strangers", settings.strangers, "Frames of as many places that are not there")
      ->capture_default_str()
      ->check(CLI::Range(0, 10'000));
  app.add_option("--seed", settings.site.seed, "Of the first place")->capture_default_str();
  app.add_option(
         "--keep", settings.folder, "Keep the databases in this folder, and use those there")
      ->check(CLI::ExistingDirectory);
  app.add_option("--most-seconds",
                 settings.most_seconds,
                 "Stop making places after this; with --keep the next run goes on")
      ->capture_default_str();
  app.add_option("--threads", settings.threads, "Of the server; 0: one a core")
      ->capture_default_str();
  app.add_option("--json", settings.json, "Write the rows to this file");
  CLI11_PARSE(app, argc, argv);
  try {
    return landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "landmarkdb-bench-scale: %s\n", error.what());
    return 1;
  }
}
