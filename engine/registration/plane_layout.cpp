#include "engine/registration/plane_layout.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

namespace landmarkdb {

namespace {

constexpr std::size_t kLooked = 4000;     // normals that the directions are taken from
constexpr float kSame = 0.97F;            // cosine, 14 deg: faces one direction
constexpr float kAcross = 0.17F;          // cosine, 80 deg: at right angles to one
constexpr double kLeastShare = 0.1;       // of the surface: faces the first direction
constexpr double kLeastAcross = 0.005;    // of the surface: at right angles to it, facing one way
constexpr double kLeastBesideBest = 0.3;  // of what faces the best second direction
constexpr std::size_t kMostBins = 4096;   // an offset further out is left out

using Vectors = std::vector<Eigen::Vector3f>;

Vectors sample(std::span<const Eigen::Vector3f> normals) {
  Vectors sampled;
  const std::size_t step = normals.size() / kLooked + 1;
  for (std::size_t i = 0; i < normals.size(); i += step) sampled.push_back(normals[i]);
  return sampled;
}

// Directions spread evenly over half the sphere (golden spiral).
Eigen::Vector3f spiral(int i, int count) {
  const double z = 1.0 - (i + 0.5) / count;
  const double r = std::sqrt(1.0 - z * z);
  const double angle = std::numbers::pi * (3.0 - std::sqrt(5.0)) * i;
  return Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
}

std::size_t facing(const Vectors& normals, const Eigen::Vector3f& direction) {
  return static_cast<std::size_t>(std::count_if(normals.begin(), normals.end(), [&](const auto& n) {
    return std::abs(n.dot(direction)) >= kSame;
  }));
}

// The mean of the normals that face the direction either way.
Eigen::Vector3f centred(const Vectors& normals, Eigen::Vector3f direction) {
  for (int pass = 0; pass < 3; ++pass) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const Eigen::Vector3f& n : normals) {
      const float cosine = n.dot(direction);
      if (std::abs(cosine) >= kSame) sum += cosine < 0.0F ? Eigen::Vector3f(-n) : n;
    }
    if (sum.norm() > 0.0F) direction = sum.normalized();
  }
  return direction;
}

std::optional<Eigen::Vector3f> first_direction(const Vectors& normals) {
  constexpr int kTried = 250;  // 9 deg apart
  Eigen::Vector3f best = Eigen::Vector3f::UnitZ();
  std::size_t most = 0;
  for (int i = 0; i < kTried; ++i) {
    const Eigen::Vector3f direction = spiral(i, kTried);
    const std::size_t count = facing(normals, direction);
    if (count > most) {
      most = count;
      best = direction;
    }
  }
  if (most == 0 || static_cast<double>(most) < kLeastShare * static_cast<double>(normals.size())) {
    return std::nullopt;
  }
  return centred(normals, best);
}

// A direction across the first, and how many of the sampled normals face it or across it.
struct Across {
  Eigen::Vector3f direction;
  double count = 0.0;
};

// Sums over angles modulo a right angle, in steps: both directions of walls count for one frame.
struct AngleHistogram {
  static constexpr int kSteps = 45;  // 2 deg
  std::array<Eigen::Vector2d, kSteps> sums;
  std::array<double, kSteps> counts{};

  AngleHistogram() { sums.fill(Eigen::Vector2d::Zero()); }  // Eigen leaves it as it finds it

  void add(double angle) {
    const double turns = 4.0 * angle / (2.0 * std::numbers::pi);
    const auto step = static_cast<std::size_t>((turns - std::floor(turns)) * kSteps) % kSteps;
    sums[step] += Eigen::Vector2d(std::cos(4.0 * angle), std::sin(4.0 * angle));
    counts[step] += 1.0;
  }

  // The angle that most fall beside, and how many; these are taken out.
  std::pair<double, double> take_peak() {
    constexpr int kWide = 2;  // steps to each side
    const auto at = [](int i) { return static_cast<std::size_t>((i + kSteps) % kSteps); };
    double most = -1.0;
    int best = 0;
    for (int i = 0; i < kSteps; ++i) {
      double count = 0.0;
      for (int d = -kWide; d <= kWide; ++d) count += counts[at(i + d)];
      if (count > most) {
        most = count;
        best = i;
      }
    }
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (int d = -kWide; d <= kWide; ++d) {
      sum += sums[at(best + d)];
      sums[at(best + d)].setZero();
      counts[at(best + d)] = 0.0;
    }
    return {0.25 * std::atan2(sum.y(), sum.x()), most};
  }
};

// The directions across `first` that most normals face, best first.
std::vector<Across> directions_across(const Vectors& normals,
                                      const Eigen::Vector3f& first,
                                      std::size_t most) {
  const Eigen::Vector3f u = first.unitOrthogonal();
  const Eigen::Vector3f v = first.cross(u);
  AngleHistogram histogram;
  for (const Eigen::Vector3f& n : normals) {
    if (std::abs(n.dot(first)) > kAcross) continue;
    histogram.add(std::atan2(static_cast<double>(n.dot(v)), static_cast<double>(n.dot(u))));
  }
  std::vector<Across> found;
  while (found.size() < most) {
    const auto [angle, count] = histogram.take_peak();
    const double least = found.empty() ? kLeastAcross * static_cast<double>(normals.size())
                                       : kLeastBesideBest * found.front().count;
    if (count < least) break;
    const auto a = static_cast<float>(angle);
    found.push_back({std::cos(a) * u + std::sin(a) * v, count});
  }
  return found;
}

// Between which all but stray points lie along the direction, and a few bins more.
std::pair<float, float> bounds_along(std::span<const Eigen::Vector3f> points,
                                     const Eigen::Vector3f& direction,
                                     float bin_m) {
  constexpr std::size_t kSampled = 20'000;
  constexpr double kStray = 0.002;  // of the points at each end
  constexpr float kBinsMore = 5.0F;
  std::vector<float> places;
  const std::size_t step = points.size() / kSampled + 1;
  for (std::size_t i = 0; i < points.size(); i += step) places.push_back(points[i].dot(direction));
  std::sort(places.begin(), places.end());
  const auto cut = static_cast<std::size_t>(kStray * static_cast<double>(places.size()));
  return {places[cut] - kBinsMore * bin_m, places[places.size() - 1 - cut] + kBinsMore * bin_m};
}

void count_offsets(std::span<const Eigen::Vector3f> points,
                   std::span<const Eigen::Vector3f> normals,
                   PlaneLayout& layout) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3f direction = layout.axes.col(static_cast<Eigen::Index>(axis));
    const auto [low, high] = bounds_along(points, direction, layout.bin_m);
    PlaneLayout::Offsets& offsets = layout.offsets[axis];
    offsets.first_m = low;
    layout.low_m[axis] = low;
    layout.high_m[axis] = high;
    const auto bins = static_cast<std::size_t>(
        std::min((high - low) / layout.bin_m + 1.0F, static_cast<float>(kMostBins)));
    for (std::vector<float>& count : offsets.count) count.assign(bins, 0.0F);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float cosine = normals[i].dot(direction);
      if (std::abs(cosine) < kSame) continue;
      const float place = (points[i].dot(direction) - low) / layout.bin_m;
      if (!(place >= 0.0F && place < static_cast<float>(bins))) continue;  // a stray point
      const auto bin = static_cast<std::size_t>(place);
      offsets.count[cosine < 0.0F ? 1 : 0][bin] += 1.0F;
    }
  }
}

}  // namespace

float PlaneLayout::Offsets::total() const {
  float sum = 0.0F;
  for (const std::vector<float>& side : count) {
    for (const float points : side) sum += points;
  }
  return sum;
}

std::vector<PlaneLayout> lay_out_planes(std::span<const Eigen::Vector3f> points,
                                        std::span<const Eigen::Vector3f> normals,
                                        double bin_m,
                                        std::size_t most) {
  std::vector<PlaneLayout> layouts;
  const Vectors sampled = sample(normals);
  const std::optional<Eigen::Vector3f> first = first_direction(sampled);
  if (!first) return layouts;
  for (const Across& second : directions_across(sampled, *first, most)) {
    PlaneLayout layout;
    layout.bin_m = static_cast<float>(bin_m);
    layout.points = points.size();
    layout.axes.col(0) = *first;
    layout.axes.col(1) = second.direction;
    layout.axes.col(2) = layout.axes.col(0).cross(layout.axes.col(1));
    count_offsets(points, normals, layout);
    layouts.push_back(std::move(layout));
  }
  return layouts;
}

}  // namespace landmarkdb
