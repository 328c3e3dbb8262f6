// A server under load: answers a second and their times with more and more clients, what a heavy
// client costs the light ones, and whether the server's memory stays flat.

#include <chrono>
#include <cstdio>
#include <exception>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "bench/load/figures.hpp"
#include "bench/load/run_clients.hpp"
#include "bench/load/server_process.hpp"
#include "bench/load/site.hpp"
#include "cli/write_file.hpp"
#include "client/client.hpp"

namespace landmarkdb::bench {
namespace {

using Clock = std::chrono::steady_clock;

struct Settings {
  ClientsOptions clients;
  std::vector<int> counts = {1, 4, 16, 64};
  SiteOptions site;
  std::size_t places = 1;
  std::size_t frames = 16;
  std::size_t light_points = 4'096;  // as many as the paper asks its lobby with
  std::size_t heavy_points = 100'000;
  std::size_t heavy_in_flight = 64;  // as many as a server takes on one connection
  int light_clients = 2;
  int light_pause_ms = 1'000;
  double seconds = 10.0;
  int server_threads = 0;
  std::string json;
};

std::vector<PointCloud> clouds_of(const Settings& settings, std::size_t points) {
  RunContext context;
  context.threads = 2;
  std::vector<PointCloud> clouds;
  for (SiteFrame& frame :
       take_frames(settings.site, settings.places, settings.frames, points, context)) {
    clouds.push_back(std::move(frame.cloud));
  }
  return clouds;
}

double resident_mb(const Settings& settings) {
  client::Client client({.server = settings.clients.server, .token = settings.clients.token}, {});
  constexpr double kMega = 1e6;
  return static_cast<double>(client.stats({}).resident_bytes) / kMega;
}

void print_figures(const std::string& name, const LoadFigures& f, double resident) {
  std::printf("%-24s %8.1f %9.1f %9.1f %9.1f %8zu %8zu %7zu %9.1f\n",
              name.c_str(),
              f.per_second,
              f.p50_ms,
              f.p95_ms,
              f.p99_ms,
              f.answered,
              f.refused,
              f.failed,
              resident);
  std::fflush(stdout);
}

// Answers that come after the end are counted, so the time runs until the last of them.
template <typename Work>
LoadFigures timed(double seconds, Work work) {
  const auto start = Clock::now();
  const auto end =
      start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  const std::vector<Request> requests = work(end);
  const std::chrono::duration<double> took = Clock::now() - start;
  return load_figures(requests, took.count());
}

nlohmann::json run_counts(const Settings& settings,
                          const std::vector<PointCloud>& clouds,
                          std::vector<double>& resident) {
  nlohmann::json rows = nlohmann::json::array();
  for (const int count : settings.counts) {
    ClientsOptions options = settings.clients;
    options.clients = count;
    const LoadFigures figures = timed(
        settings.seconds, [&](Clock::time_point end) { return run_clients(options, clouds, end); });
    resident.push_back(resident_mb(settings));
    print_figures(std::to_string(count) + " clients", figures, resident.back());
    nlohmann::json row = to_json(figures);
    row["clients"] = count;
    row["resident_mb"] = resident.back();
    rows.push_back(row);
  }
  return rows;
}

Fairness run_fairness(const Settings& settings,
                      const std::vector<PointCloud>& light,
                      const std::vector<PointCloud>& heavy) {
  ClientsOptions options = settings.clients;
  options.clients = settings.light_clients;
  options.pause = std::chrono::milliseconds(settings.light_pause_ms);
  const auto ask_light = [&](Clock::time_point end) { return run_clients(options, light, end); };
  Fairness fairness;
  fairness.alone = timed(settings.seconds, ask_light);
  std::exception_ptr failure;
  {
    const std::jthread beside([&] {
      try {
        fairness.heavy = timed(settings.seconds, [&](Clock::time_point end) {
          return run_heavy_client(options, settings.heavy_in_flight, heavy, end);
        });
      } catch (...) {
        failure = std::current_exception();
      }
    });
    fairness.beside_heavy = timed(settings.seconds, ask_light);
  }
  if (failure) std::rethrow_exception(failure);
  return fairness;
}

void run(Settings settings) {
  std::unique_ptr<testing::TempFolder> folder;
  std::unique_ptr<ServerProcess> server;
  if (settings.clients.server.empty()) {
    RunContext context;
    context.threads = 2;
    folder = std::make_unique<testing::TempFolder>();
    const std::string db = folder->file("load.db");
    constexpr double kPatience_s = 3600.0;
    fill_database(db, settings.site, settings.places, kPatience_s, context);
    server = std::make_unique<ServerProcess>(db, settings.server_threads);
    settings.clients.server = server->address();
  }
  const std::vector<PointCloud> light = clouds_of(settings, settings.light_points);
  std::vector<double> resident = {resident_mb(settings)};
  std::printf("%-24s %8s %9s %9s %9s %8s %8s %7s %9s\n",
              "",
              "a second",
              "p50 ms",
              "p95 ms",
              "p99 ms",
              "answered",
              "refused",
              "failed",
              "server MB");
  std::printf("%-24s %81.1f\n", "at the start", resident.front());
  nlohmann::json json{{"seed", settings.site.seed},
                      {"places", settings.places},
                      {"place_points", settings.site.points},
                      {"cloud_points", settings.light_points},
                      {"seconds_each", settings.seconds}};
  json["clients"] = run_counts(settings, light, resident);
  if (settings.heavy_in_flight > 0) {
    const Fairness fairness =
        run_fairness(settings, light, clouds_of(settings, settings.heavy_points));
    resident.push_back(resident_mb(settings));
    print_figures("light alone", fairness.alone, resident.back());
    print_figures("light beside heavy", fairness.beside_heavy, resident.back());
    print_figures("heavy", fairness.heavy, resident.back());
    std::printf("95 of 100 answers to light clients take %.1f times as long beside the heavy one\n",
                fairness.p95_ratio());
    json["fairness"] = to_json(fairness);
  }
  json["resident_mb"] = resident;
  json["resident_growth"] = growth(resident);
  if (server) {
    json["peak_resident_mb"] = static_cast<double>(server->peak_resident_bytes()) / 1e6;
  }
  if (!settings.json.empty()) cli::write_file(settings.json, json.dump(1) + "\n", "--json");
}

void add_options(CLI::App& app, Settings& settings) {
  app.add_option("--server",
                 settings.clients.server,
                 "Ask this one, HOST:PORT or unix:PATH; else one is started on generated places");
  app.add_option("--token", settings.clients.token, "That the server asks for");
  app.add_option("--clients", settings.counts, "Numbers of clients, one after another")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--seconds", settings.seconds, "For each row")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0));
  app.add_option("--seed", settings.site.seed, "Of the first place")->capture_default_str();
  app.add_option("--places", settings.places, "Generated places that frames are taken in")
      ->capture_default_str()
      ->check(CLI::Range(1, 9999));
  app.add_option("--place-points", settings.site.points, "Scanned points of each")
      ->capture_default_str();
  app.add_option("--frames", settings.frames, "Frames that are asked with in turn")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--points", settings.light_points, "Of a frame of the ordinary clients")
      ->capture_default_str();
  app.add_option("--heavy-points", settings.heavy_points, "Of a frame of the heavy client")
      ->capture_default_str();
  app.add_option("--heavy", settings.heavy_in_flight, "Questions it keeps open; 0: no such client")
      ->capture_default_str();
  app.add_option("--light", settings.light_clients, "Light clients beside it")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  app.add_option("--pause", settings.light_pause_ms, "Of a light client between questions, ms")
      ->capture_default_str()
      ->check(CLI::Range(0, 3'600'000));
  app.add_option("--threads", settings.server_threads, "Of the server; 0: one a core")
      ->capture_default_str();
  app.add_option("--json", settings.json, "Write the figures to this file");
}

}  // namespace
}  // namespace landmarkdb::bench

int main(int argc, char** argv) {
  landmarkdb::bench::Settings settings;
  CLI::App app{
      "A server under load: answers a second, their times, refusals, what a heavy client costs "
      "light ones, and the server's memory from start to end"};
  landmarkdb::bench::add_options(app, settings);
  CLI11_PARSE(app, argc, argv);
  try {
    landmarkdb::bench::run(settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "landmarkdb-bench-load: %s\n", error.what());
    return 1;
  }
  return 0;
}
