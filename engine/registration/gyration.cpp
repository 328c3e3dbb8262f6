#include "engine/registration/gyration.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace landmarkdb {

namespace {

constexpr double kMostMedians = 20.0;  // an outdoor turn of a laser has points at 12

struct Moments {
  Gyration gyration;
  double farthest_m = 0.0;  // from the centre
};

Moments moments_of(std::span<const Eigen::Vector3f> points) {
  Moments moments;
  if (points.empty()) return moments;
  Gyration& gyration = moments.gyration;
  const auto count = static_cast<double>(points.size());
  for (const Eigen::Vector3f& p : points) gyration.centre += p.cast<double>();
  gyration.centre /= count;
  double sum = 0.0;
  double farthest = 0.0;
  for (const Eigen::Vector3f& p : points) {
    const double squared = (p.cast<double>() - gyration.centre).squaredNorm();
    sum += squared;
    farthest = std::max(farthest, squared);
  }
  gyration.radius_m = std::sqrt(sum / count);
  moments.farthest_m = std::sqrt(farthest);
  return moments;
}

float median(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// What some of the points, evenly chosen, say of the bulk of them.
struct Bulk {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  double distance_m = 0.0;
};

Bulk bulk_of(std::span<const Eigen::Vector3f> points) {
  constexpr std::size_t kLooked = 200;
  const std::size_t step = points.size() / kLooked + 1;
  Bulk bulk;
  std::vector<float> values;
  for (int axis = 0; axis < 3; ++axis) {
    values.clear();
    for (std::size_t i = 0; i < points.size(); i += step) values.push_back(points[i][axis]);
    bulk.centre[axis] = median(values);
  }
  values.clear();
  for (std::size_t i = 0; i < points.size(); i += step) {
    values.push_back((points[i] - bulk.centre).norm());
  }
  bulk.distance_m = static_cast<double>(median(values));
  return bulk;
}

}  // namespace

Gyration measure_gyration(std::span<const Eigen::Vector3f> points) {
  const Moments all = moments_of(points);
  if (points.empty()) return all.gyration;
  const Bulk bulk = bulk_of(points);
  const double most_m = kMostMedians * bulk.distance_m;
  // A mean that far points have moved is no further from them than the bulk is.
  if (all.farthest_m <= 0.5 * most_m) return all.gyration;
  std::vector<Eigen::Vector3f> near;
  near.reserve(points.size());
  for (const Eigen::Vector3f& p : points) {
    if (static_cast<double>((p - bulk.centre).norm()) <= most_m) near.push_back(p);
  }
  return moments_of(near).gyration;
}

}  // namespace landmarkdb
