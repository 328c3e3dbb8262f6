#include "datasets/scanner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "datasets/ray_noise.hpp"
#include "datasets/subsample.hpp"
#include "engine/base/error.hpp"
#include "engine/base/parallel.hpp"

namespace landmarkdb::datasets {
namespace {

constexpr float kNoRange = 0.0F;
constexpr double kFinestStep_rad = 2e-4;  // 1.5e9 rays a station: what real scanners end at
// Beside a depth jump of this size a beam may straddle the edge.
constexpr float kEdge_m = 0.05F;

// Rays of one station: columns turn about z, rows sweep from the lowest elevation to the zenith.
struct Grid {
  std::size_t columns = 0, rows = 0;
  double step_rad = 0.0, lowest_rad = 0.0;

  std::size_t size() const { return columns * rows; }
  Eigen::Vector3f direction(std::size_t i) const {
    const double azimuth = step_rad * static_cast<double>(i / rows);
    const double elevation = lowest_rad + step_rad * static_cast<double>(i % rows);
    return Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth),
                           std::cos(elevation) * std::sin(azimuth),
                           std::sin(elevation))
        .cast<float>();
  }
};

Grid make_grid(double step_rad, double lowest_rad) {
  Grid grid;
  grid.columns = static_cast<std::size_t>(std::max(4.0, 2.0 * std::numbers::pi / step_rad));
  grid.step_rad = 2.0 * std::numbers::pi / static_cast<double>(grid.columns);
  grid.lowest_rad = lowest_rad;
  grid.rows = static_cast<std::size_t>((0.5 * std::numbers::pi - lowest_rad) / grid.step_rad) + 1;
  return grid;
}

void check(const Place& place, const ScannerOptions& options) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorCode::kInvalidArgument, "scanner: " + what);
  };
  if (place.stations.empty()) refuse("the place has no station to scan from");
  if (options.points > 200'000'000) refuse("more than 200,000,000 points wanted");
  if (options.points == 0 && !(options.step_rad >= kFinestStep_rad && options.step_rad <= 0.2)) {
    refuse("the angular step must be 0.0002 to 0.2 rad, not " + std::to_string(options.step_rad));
  }
  if (!(options.lowest_rad >= -1.5 && options.lowest_rad <= 1.0)) {
    refuse("the lowest ray must be at -1.5 to 1 rad, not " + std::to_string(options.lowest_rad));
  }
  if (!(options.noise_m >= 0.0 && options.noise_m < 1.0)) {
    refuse("the noise must be 0 to 1 m, not " + std::to_string(options.noise_m));
  }
}

// True ranges, kNoRange where nothing comes back.
std::vector<float> cast(const Place& place,
                        const Eigen::Isometry3d& T_scene_station,
                        const Grid& grid,
                        const ScannerOptions& options,
                        int threads) {
  std::vector<float> ranges(grid.size(), kNoRange);
  const Eigen::Matrix3f R = T_scene_station.linear().cast<float>();
  const Eigen::Vector3f origin = T_scene_station.translation().cast<float>();
  parallel_chunks(grid.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto hit = place.caster->first_hit(
          origin, R * grid.direction(i), static_cast<float>(options.max_range_m));
      if (hit && hit->returns_light && hit->distance_m > options.min_range_m) {
        ranges[i] = hit->distance_m;
      }
    }
  });
  return ranges;
}

// What the scanner reports for ray `i`: noise, and mixed pixels beside depth edges.
float measure(const std::vector<float>& ranges,
              const Grid& grid,
              std::size_t i,
              const ScannerOptions& options,
              std::uint64_t seed) {
  const float range = ranges[i];
  if (range == kNoRange) return kNoRange;
  Random random = ray_random(seed, i);
  if (random.uniform() < options.dropout) return kNoRange;
  double reported = range;
  const std::size_t neighbour = random.uniform() < 0.5     ? (i + grid.rows) % grid.size()
                                : (i + 1) % grid.rows == 0 ? i
                                                           : i + 1;
  const float other = ranges[neighbour];
  if (other != kNoRange && std::abs(other - range) > kEdge_m &&
      random.uniform() < options.mixed_pixels) {
    reported = random.uniform(std::min(range, other), std::max(range, other));
  }
  return static_cast<float>(reported + options.noise_m * random.normal());
}

struct RawScan {
  Grid grid;
  std::vector<float> ranges;  // as reported
};

std::vector<RawScan> scan_all(const Place& place,
                              double step_rad,
                              const ScannerOptions& options,
                              const RunContext& context) {
  std::vector<RawScan> scans;
  for (std::size_t s = 0; s < place.stations.size(); ++s) {
    context.report("scan", s, place.stations.size());
    RawScan scan{make_grid(step_rad, options.lowest_rad), {}};
    const std::vector<float> truth =
        cast(place, place.stations[s], scan.grid, options, context.threads);
    scan.ranges.resize(truth.size());
    const std::uint64_t seed = Random(options.seed + 0x100000001b3ULL * (s + 1)).next();
    parallel_chunks(truth.size(), context.threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        scan.ranges[i] = measure(truth, scan.grid, i, options, seed);
      }
    });
    scans.push_back(std::move(scan));
  }
  context.report("scan", place.stations.size(), place.stations.size());
  return scans;
}

std::size_t count_returns(const std::vector<RawScan>& scans) {
  std::size_t returns = 0;
  for (const RawScan& scan : scans) {
    returns += scan.ranges.size() - static_cast<std::size_t>(std::count(
                                        scan.ranges.begin(), scan.ranges.end(), kNoRange));
  }
  return returns;
}

// The step at which all stations together return a little more than `points`.
double step_for(const Place& place, const ScannerOptions& options, const RunContext& context) {
  constexpr double kPilotStep_rad = 0.06;
  constexpr double kSpare = 1.03;
  RunContext quiet = context;
  quiet.progress = nullptr;
  const std::size_t returns = count_returns(scan_all(place, kPilotStep_rad, options, quiet));
  const double wanted = kSpare * static_cast<double>(std::max<std::size_t>(options.points, 1));
  return kPilotStep_rad * std::sqrt(static_cast<double>(returns) / wanted);
}

std::vector<RawScan> scan_enough(const Place& place,
                                 const ScannerOptions& options,
                                 const RunContext& context) {
  if (options.points == 0) return scan_all(place, options.step_rad, options, context);
  double step_rad = std::min(0.2, step_for(place, options, context));
  constexpr double kFiner = 0.97;
  for (; step_rad >= kFinestStep_rad; step_rad *= kFiner) {
    std::vector<RawScan> scans = scan_all(place, step_rad, options, context);
    if (count_returns(scans) >= options.points) return scans;
  }
  throw Error(ErrorCode::kInvalidArgument,
              "scanner: the place's " + std::to_string(place.stations.size()) +
                  " stations cannot return " + std::to_string(options.points) + " points");
}

}  // namespace

std::vector<StationScan> scan_place(const Place& place,
                                    const ScannerOptions& options,
                                    const RunContext& context) {
  check(place, options);
  const std::vector<RawScan> raw = scan_enough(place, options, context);
  const std::size_t returns = count_returns(raw);
  const std::vector<std::size_t> kept =
      choose(returns, options.points == 0 ? returns : options.points, options.seed);
  std::vector<StationScan> scans;
  std::size_t seen = 0;
  auto next = kept.begin();
  for (std::size_t s = 0; s < raw.size(); ++s) {
    StationScan scan{{}, place.stations[s]};
    scan.cloud.viewpoints = {Eigen::Vector3f::Zero()};
    for (std::size_t i = 0; i < raw[s].ranges.size(); ++i) {
      if (raw[s].ranges[i] == kNoRange) continue;
      if (next != kept.end() && *next == seen) {
        scan.cloud.points.emplace_back(raw[s].ranges[i] * raw[s].grid.direction(i));
        ++next;
      }
      ++seen;
    }
    scans.push_back(std::move(scan));
  }
  return scans;
}

PointCloud merge_stations(const std::vector<StationScan>& scans) {
  PointCloud all;
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const Eigen::Isometry3f T = scans[s].T_scene_station.cast<float>();
    all.viewpoints.emplace_back(T.translation());
    for (const Eigen::Vector3f& p : scans[s].cloud.points) all.points.emplace_back(T * p);
    all.viewpoint_index.resize(all.points.size(), static_cast<std::uint16_t>(s));
  }
  return all;
}

}  // namespace landmarkdb::datasets
