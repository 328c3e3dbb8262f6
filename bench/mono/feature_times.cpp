#include "bench/mono/feature_times.hpp"

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "bench/mono/pictures.hpp"
#include "engine/mono/find_features.hpp"

namespace landmarkdb::bench {
namespace {

constexpr int kTurns = 3;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Timed {
  std::size_t edges = 0, points = 0;
  double ms = 0.0;
};

nlohmann::json print_row(const char* name, std::vector<Timed> rows) {
  std::sort(rows.begin(), rows.end(), [](const Timed& a, const Timed& b) { return a.ms < b.ms; });
  double edges = 0.0, points = 0.0;
  for (const Timed& row : rows) {
    edges += static_cast<double>(row.edges) / static_cast<double>(rows.size());
    points += static_cast<double>(row.points) / static_cast<double>(rows.size());
  }
  const double median = rows[rows.size() / 2].ms, p95 = rows[(rows.size() - 1) * 95 / 100].ms;
  std::printf(
      "%-28s %4zu pictures, %6.0f edge points, %4.0f features: median %.2f ms, p95 %.2f ms\n",
      name,
      rows.size(),
      edges,
      points,
      median,
      p95);
  return {{"pictures", rows.size()}, {"edges", edges}, {"median_ms", median}, {"p95_ms", p95}};
}

}  // namespace

nlohmann::json feature_times(const Settings& settings) {
  const PictureOptions options{.models = settings.picture_models,
                               .pictures = std::max<std::size_t>(2, settings.pictures),
                               .seed = settings.seed};
  const auto catalog = make_picture_catalog(options.seed, options.models);
  std::vector<Timed> rows;
  for (std::size_t i = 0; i < options.pictures; ++i) {
    const Picture picture = make_picture(*catalog, options, i);
    Timed row;
    for (int turn = 0; turn < kTurns; ++turn) {
      const double begin = cpu_ms();
      const ImageFeatures features = find_image_features(picture.image, {}, {});
      const double ms = cpu_ms() - begin;
      row.ms = turn == 0 ? ms : std::min(row.ms, ms);
      row.edges = features.edges.size();
      row.points = features.points.size();
    }
    rows.push_back(row);
  }
  std::stable_sort(
      rows.begin(), rows.end(), [](const Timed& a, const Timed& b) { return a.edges > b.edges; });
  const std::vector<Timed> crowded(rows.begin(),
                                   rows.begin() + static_cast<std::ptrdiff_t>(rows.size() / 2));
  return {{"all", print_row("features, all", rows)},
          {"crowded", print_row("features, the crowded half", crowded)}};
}

}  // namespace landmarkdb::bench
