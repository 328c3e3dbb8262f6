#include "engine/registration/spread.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace landmarkdb {

namespace {

struct Moments {
  Spread spread;
  double farthest_m = 0.0;
};

Moments moments_of(std::span<const Eigen::Vector3f> points) {
  Moments moments;
  if (points.empty()) return moments;
  const auto count = static_cast<double>(points.size());
  for (const Eigen::Vector3f& p : points) moments.spread.centre += p.cast<double>();
  moments.spread.centre /= count;
  double sum = 0.0;
  double farthest = 0.0;
  for (const Eigen::Vector3f& p : points) {
    const double squared = (p.cast<double>() - moments.spread.centre).squaredNorm();
    sum += squared;
    farthest = std::max(farthest, squared);
  }
  moments.spread.radius_m = std::sqrt(sum / count);
  moments.farthest_m = std::sqrt(farthest);
  return moments;
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<Eigen::Vector3f> without_far_ones(std::span<const Eigen::Vector3f> points) {
  constexpr float kMostMedians = 20.0F;
  Eigen::Vector3f centre;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (const Eigen::Vector3f& p : points) values.push_back(p[axis]);
    centre[axis] = median(values);
  }
  values.clear();
  for (const Eigen::Vector3f& p : points) values.push_back((p - centre).norm());
  const float most_m = kMostMedians * median(values);
  std::vector<Eigen::Vector3f> near;
  for (const Eigen::Vector3f& p : points) {
    if ((p - centre).norm() <= most_m) near.push_back(p);
  }
  return near;
}

}  // namespace

Spread measure_spread(std::span<const Eigen::Vector3f> points) {
  constexpr double kFarRoots = 12.0;
  const Moments all = moments_of(points);
  if (all.farthest_m <= kFarRoots * all.spread.radius_m) return all.spread;
  return moments_of(without_far_ones(points)).spread;
}

}  // namespace landmarkdb
