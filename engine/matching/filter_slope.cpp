#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "engine/base/error.hpp"
#include "engine/matching/filters.hpp"

namespace landmarkdb {
namespace {

constexpr double kPi = std::numbers::pi;

// Angles of lines: the same line again after half a turn.
double fold(double angle_rad) {
  const double folded = std::remainder(angle_rad, kPi);  // [-pi/2, pi/2]
  return folded == -kPi / 2.0 ? kPi / 2.0 : folded;
}

// One angle a pair; none where the pair has no line in that plane.
using Slopes = std::vector<std::optional<double>>;

std::optional<double> slope(double rise, double run) {
  if (rise == 0.0 && run == 0.0) return std::nullopt;
  return fold(std::atan2(rise, run));
}

struct Gaussian {
  double mean_rad = 0.0;
  double sigma_rad = 0.0;
};

// Maximum likelihood of a Gaussian on the angles of lines, over the pairs that are still `alive`.
std::optional<Gaussian> fit(const Slopes& slopes, const std::vector<bool>& alive) {
  double cosines = 0.0;
  double sines = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (!alive[i] || !slopes[i]) continue;
    cosines += std::cos(2.0 * *slopes[i]);
    sines += std::sin(2.0 * *slopes[i]);
    ++count;
  }
  if (count == 0) return std::nullopt;
  const double direction = std::atan2(sines, cosines) / 2.0;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (!alive[i] || !slopes[i]) continue;
    const double deviation = fold(*slopes[i] - direction);
    sum += deviation;
    squares += deviation * deviation;
  }
  const double mean = sum / static_cast<double>(count);
  const double variance = std::max(squares / static_cast<double>(count) - mean * mean, 0.0);
  return Gaussian{fold(direction + mean), std::sqrt(variance)};
}

// Drops what is out of the Gaussian's reach; true when something was.
bool drop_far(const Slopes& slopes,
              const Gaussian& gaussian,
              const SlopeOptions& options,
              std::vector<bool>& alive) {
  const double reach = options.max_sigma * std::max(gaussian.sigma_rad, options.min_sigma_rad);
  bool dropped = false;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (!alive[i] || !slopes[i]) continue;
    if (std::abs(fold(*slopes[i] - gaussian.mean_rad)) > reach) {
      alive[i] = false;
      dropped = true;
    }
  }
  return dropped;
}

bool near(const Slopes& slopes, std::size_t a, std::size_t b, double reach_rad) {
  return !slopes[a] || !slopes[b] || std::abs(fold(*slopes[a] - *slopes[b])) <= reach_rad;
}

std::size_t near_in_both(const std::array<Slopes, 2>& slopes,
                         std::size_t centre,
                         double reach_rad) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < slopes[0].size(); ++i) {
    if (near(slopes[0], centre, i, reach_rad) && near(slopes[1], centre, i, reach_rad)) ++count;
  }
  return count;
}

// The pairs within twice the reach of the one that has most others within reach (the first of
// equals); all where none has both slopes.
std::vector<bool> densest(const std::array<Slopes, 2>& slopes, double reach_rad) {
  constexpr std::size_t kMostCentres = 1000;  // evenly picked: bounds the cost
  const std::size_t count = slopes[0].size();
  const std::size_t centres = std::min(count, kMostCentres);
  std::optional<std::size_t> best;
  std::size_t most = 0;
  for (std::size_t c = 0; c < centres; ++c) {
    const std::size_t centre = c * count / centres;
    if (!slopes[0][centre] || !slopes[1][centre]) continue;
    const std::size_t members = near_in_both(slopes, centre, reach_rad);
    if (members <= most) continue;
    most = members;
    best = centre;
  }
  std::vector<bool> alive(count, true);
  for (std::size_t i = 0; best && i < count; ++i) {
    alive[i] =
        near(slopes[0], *best, i, 2.0 * reach_rad) && near(slopes[1], *best, i, 2.0 * reach_rad);
  }
  return alive;
}

}  // namespace

std::vector<Correspondence> filter_slope(std::span<const Correspondence> correspondences,
                                         std::span<const Eigen::Vector3f> target,
                                         std::span<const Eigen::Vector3f> query,
                                         const SlopeOptions& options) {
  if (!(options.max_sigma > 0.0) || !(options.min_sigma_rad >= 0.0) ||
      !(options.start_reach_rad > 0.0)) {
    throw Error(ErrorCode::kInvalidArgument,
                "slope filter reaches " + std::to_string(options.max_sigma) +
                    " standard deviations of at least " + std::to_string(options.min_sigma_rad) +
                    " rad from a start of " + std::to_string(options.start_reach_rad) +
                    " rad, want positive numbers");
  }
  std::array<Slopes, 2> slopes;  // m1, m2
  for (const Correspondence& pair : correspondences) {
    if (pair.target >= target.size() || pair.query >= query.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "correspondence of query " + std::to_string(pair.query) + " and target " +
                      std::to_string(pair.target) + " for " + std::to_string(query.size()) +
                      " and " + std::to_string(target.size()) + " keypoints");
    }
    const Eigen::Vector3d d = target[pair.target].cast<double>() - query[pair.query].cast<double>();
    slopes[0].push_back(slope(d.y(), d.x()));
    slopes[1].push_back(slope(d.z(), d.x()));
  }
  std::vector<bool> alive = densest(slopes, options.start_reach_rad);
  bool changed = true;
  while (changed) {  // each round but the last drops a pair, so it ends
    // Both fits are of the same pairs, so neither slope goes first.
    const std::array fits = {fit(slopes[0], alive), fit(slopes[1], alive)};
    changed = false;
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      if (fits[i]) changed = drop_far(slopes[i], *fits[i], options, alive) || changed;
    }
  }
  std::vector<Correspondence> kept;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    if (alive[i]) kept.push_back(correspondences[i]);
  }
  return kept;
}

}  // namespace landmarkdb
