#include <algorithm>
#include <cmath>

#include "engine/mono/fit_chains.hpp"

namespace landmarkdb {
namespace {

struct LineSums {
  double n = 0.0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double xx = 0.0, xy = 0.0, yy = 0.0;

  void add(const Eigen::Vector2d& p) {
    n += 1.0;
    sum += p;
    xx += p.x() * p.x();
    xy += p.x() * p.y();
    yy += p.y() * p.y();
  }
};

// Of sums about `origin`. The direction's sign is open.
void solve(const LineSums& sums, const Eigen::Vector2d& origin, FittedLine& line) {
  const Eigen::Vector2d mean = sums.sum / sums.n;
  const double a = sums.xx / sums.n - mean.x() * mean.x();
  const double b = sums.xy / sums.n - mean.x() * mean.y();
  const double c = sums.yy / sums.n - mean.y() * mean.y();
  const double angle = 0.5 * std::atan2(2.0 * b, a - c);
  const double half = 0.5 * (a + c), root = std::hypot(0.5 * (a - c), b);
  line.center = mean + origin;
  line.direction = {std::cos(angle), std::sin(angle)};
  line.spread_px = std::sqrt(half + root);
  line.rms_px = std::sqrt(std::max(0.0, half - root));
  line.points = static_cast<std::size_t>(sums.n);
}

Eigen::Vector2d normal_of(const Eigen::Vector2d& direction) {
  return {direction.y(), -direction.x()};  // to the left, as the screen shows it
}

}  // namespace

double FittedLine::sigma_at(double along) const {
  constexpr double kLeastRms = 0.1;     // what sub-pixel positions of edges are good for at best
  constexpr double kIndependent = 3.0;  // smoothing makes neighbours move together
  const double n = static_cast<double>(points) / kIndependent;
  const double s = std::max(rms_px, kLeastRms);
  const double lever = along / std::max(spread_px, 1.0);
  return s * std::sqrt((1.0 + lever * lever) / std::max(n, 1.0));
}

FittedLine fit_line(std::span<const EdgePoint> points) {
  constexpr double kLeastCosine = 0.966;  // 15 degrees
  constexpr double kSigmas = 2.5, kLeastBand_px = 0.4;
  constexpr double kReach_px = 1.0;
  FittedLine line;
  if (points.size() < 3) return line;
  const Eigen::Vector2d origin = points[points.size() / 2].uv.cast<double>();
  LineSums all;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  for (const EdgePoint& p : points) {
    all.add(p.uv.cast<double>() - origin);
    gradient += p.normal.cast<double>();
  }
  solve(all, origin, line);
  double band = 1e9;  // the first round sorts by direction only
  for (int round = 0; round < 2; ++round) {
    if (normal_of(line.direction).dot(gradient) < 0.0) line.direction = -line.direction;
    const Eigen::Vector2d normal = normal_of(line.direction);
    LineSums kept;
    double from = 1e9, to = -1e9;
    for (const EdgePoint& p : points) {
      const double across = std::abs((p.uv.cast<double>() - line.center).dot(normal));
      if (across < kReach_px) {  // towards a corner the gradient turns, and the edge goes on
        const double along = (p.uv.cast<double>() - origin).dot(line.direction);
        from = std::min(from, along);
        to = std::max(to, along);
      }
      if (across < band && p.normal.cast<double>().dot(normal) > kLeastCosine) {
        kept.add(p.uv.cast<double>() - origin);
      }
    }
    if (kept.n < 3.0 || !(to > from)) return FittedLine{};
    const Eigen::Vector2d before = line.direction;
    solve(kept, origin, line);
    if (line.direction.dot(before) < 0.0) line.direction = -line.direction;
    const double offset = (line.center - origin).dot(before);
    line.from = from - offset;
    line.to = to - offset;
    band = std::max(kLeastBand_px, kSigmas * line.rms_px);
  }
  return line;
}

}  // namespace landmarkdb
