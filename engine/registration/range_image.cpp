#include "engine/registration/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace landmarkdb {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kWidestPatch = 6;  // cells to each side: what stands at the lens fills no more

}  // namespace

RangeImage::RangeImage(std::span<const Eigen::Vector3f> points,
                       const Eigen::Vector3f& viewpoint,
                       double finest_step_rad)
    : viewpoint_(viewpoint), step_rad_(finest_step_rad) {
  constexpr double kEnough = 0.6;        // of the measured cells have measured neighbours
  constexpr double kCoarsestRad = 0.14;  // 8 deg
  for (;; step_rad_ *= 2.0) {
    measure(points);
    if (complete_share() >= kEnough || step_rad_ >= kCoarsestRad) break;
  }
  measure_cone(points);
}

void RangeImage::measure_cone(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) sum += (point - viewpoint_).stableNormalized();
  if (!(sum.norm() > 0.0F)) return;
  cone_axis_ = sum.normalized();
  float least = 1.0F;
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f ray = point - viewpoint_;
    if (ray.norm() > 0.0F) least = std::min(least, cone_axis_.dot(ray) / ray.norm());
  }
  // From a measured direction to the centre of a patch that still fills its cell: so many cells
  // along both sides, and a cell for the directions' places in theirs.
  constexpr double kDiagonal = std::numbers::sqrt2;
  const double beyond = kDiagonal * (kWidestPatch + 2) * step_rad_;
  const double half_angle = std::acos(std::clamp(static_cast<double>(least), -1.0, 1.0)) + beyond;
  cone_cosine_ = half_angle < std::numbers::pi ? static_cast<float>(std::cos(half_angle)) : -1.0F;
}

void RangeImage::measure(std::span<const Eigen::Vector3f> points) {
  side_ = std::max(4, static_cast<int>(std::ceil(0.5 * std::numbers::pi / step_rad_)));
  cells_.assign(6 * static_cast<std::size_t>(side_ * side_), Cell{kInfinity, 0.0F});
  for (const Eigen::Vector3f& point : points) {
    const Eigen::Vector3f ray = point - viewpoint_;
    const float range = ray.norm();
    if (!(range > 0.0F)) continue;
    Cell& cell = cells_[index_of(place_of(ray))];
    cell.nearest = std::min(cell.nearest, range);
    cell.furthest = std::max(cell.furthest, range);
    max_range_m_ = std::max(max_range_m_, range);
  }
  widened_.clear();
  widened_.reserve(cells_.size());
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) widened_.push_back(widen(cell));
}

double RangeImage::complete_share() const {
  std::size_t measured = 0;
  std::size_t complete = 0;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    measured += cells_[i].furthest > 0.0F ? 1U : 0U;
    complete += widened_[i].furthest > 0.0F ? 1U : 0U;
  }
  return measured == 0 ? 0.0 : static_cast<double>(complete) / static_cast<double>(measured);
}

RangeImage::Place RangeImage::place_of(const Eigen::Vector3f& ray) const {
  int axis = 0;
  ray.cwiseAbs().maxCoeff(&axis);
  const float depth = std::abs(ray(axis));
  const auto along = [&](float v) {
    const float angle =
        std::atan(v / depth) * (4.0F / std::numbers::pi_v<float>);  // -1..1 over the face
    return std::clamp(
        static_cast<int>((angle + 1.0F) * 0.5F * static_cast<float>(side_)), 0, side_ - 1);
  };
  return {2 * axis + (ray(axis) < 0.0F ? 1 : 0),
          along(ray((axis + 1) % 3)),
          along(ray((axis + 2) % 3))};
}

std::size_t RangeImage::index_of(const Place& place) const {
  return static_cast<std::size_t>((place.face * side_ + place.row) * side_ + place.column);
}

RangeImage::Cell RangeImage::widen(std::size_t cell) const {
  const int index = static_cast<int>(cell);
  const Place place{index / (side_ * side_), (index / side_) % side_, index % side_};
  Cell wide{kInfinity, 0.0F};
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      // At a face's edge the cell itself stands in for the neighbour on the next face.
      const Place beside{place.face,
                         std::clamp(place.row + dy, 0, side_ - 1),
                         std::clamp(place.column + dx, 0, side_ - 1)};
      const Cell& other = cells_[index_of(beside)];
      if (!(other.furthest > 0.0F)) return Cell{0.0F, 0.0F};
      wide.nearest = std::min(wide.nearest, other.nearest);
      wide.furthest = std::max(wide.furthest, other.furthest);
    }
  }
  return wide;
}

SightCounts& SightCounts::operator+=(const SightCounts& other) {
  measured += other.measured;
  agree += other.agree;
  crossed += other.crossed;
  hidden += other.hidden;
  solid += other.solid;
  return *this;
}

std::vector<RangeImage::Predicted> RangeImage::render(const SightSurface& surface,
                                                      const Eigen::Isometry3d& T_here_surface,
                                                      float patch_m) const {
  const Eigen::Matrix3f R = T_here_surface.linear().cast<float>();
  const Eigen::Vector3f t = T_here_surface.translation().cast<float>() - viewpoint_;
  const float reach = 2.0F * max_range_m_;  // what lies further could only be hidden
  std::vector<Predicted> predicted(cells_.size(), {kInfinity, false});
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const Eigen::Vector3f ray = R * surface.points[i] + t;
    const float range = ray.norm();
    if (!(range > 0.0F) || range > reach || cone_axis_.dot(ray) < cone_cosine_ * range) continue;
    const bool back = !surface.normals.empty() && ray.dot(R * surface.normals[i]) > 0.0F;
    const Place place = place_of(ray);
    const float half_patch = 0.5F * patch_m / (range * static_cast<float>(step_rad_));
    const int half =
        static_cast<int>(std::min(static_cast<float>(kWidestPatch), half_patch + 0.5F));
    for (int row = std::max(0, place.row - half); row <= std::min(side_ - 1, place.row + half);
         ++row) {
      for (int column = std::max(0, place.column - half);
           column <= std::min(side_ - 1, place.column + half);
           ++column) {
        Predicted& nearest = predicted[index_of({place.face, row, column})];
        if (range < nearest.range) nearest = {range, back};
      }
    }
  }
  return predicted;
}

std::size_t RangeImage::solid(const std::vector<signed char>& says) const {
  std::size_t count = 0;
  for (std::size_t cell = 0; cell < says.size(); ++cell) {
    if (says[cell] >= 0) continue;
    const int index = static_cast<int>(cell);
    const Place place{index / (side_ * side_), (index / side_) % side_, index % side_};
    bool alone = false;
    for (int row = std::max(0, place.row - 1); row <= std::min(side_ - 1, place.row + 1); ++row) {
      for (int column = std::max(0, place.column - 1);
           column <= std::min(side_ - 1, place.column + 1);
           ++column) {
        alone = alone || says[index_of({place.face, row, column})] > 0;
      }
    }
    count += alone ? 0U : 1U;
  }
  return count;
}

bool RangeImage::hides(const Eigen::Vector3f& p, float slack_m) const {
  const Eigen::Vector3f ray = p - viewpoint_;
  const float range = ray.norm();
  if (!(range > 0.0F) || cone_axis_.dot(ray) < cone_cosine_ * range) return false;
  const Cell& wide = widened_[index_of(place_of(ray))];
  return wide.furthest > 0.0F && range > wide.furthest + slack_m;
}

SightCounts RangeImage::compare(const SightSurface& surface,
                                const Eigen::Isometry3d& T_here_surface,
                                float patch_m,
                                const SightTolerance& tolerance) const {
  const std::vector<Predicted> predicted = render(surface, T_here_surface, patch_m);
  SightCounts counts;
  std::vector<signed char> says(cells_.size(), 0);  // 1: agrees, -1: contradicts, 0: nothing
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& wide = widened_[i];
    if (!(wide.furthest > 0.0F)) continue;
    ++counts.measured;
    if (predicted[i].range == kInfinity) continue;
    const bool front = !predicted[i].back;
    const float slack = tolerance.metres + tolerance.share * wide.furthest;
    if (predicted[i].range < wide.nearest - slack) {
      ++counts.crossed;
      says[i] = -1;
    } else if (front && predicted[i].range <= wide.furthest + slack) {
      ++counts.agree;
      says[i] = 1;
    } else if (front) {
      ++counts.hidden;
      says[i] = -1;
    }
  }
  counts.solid = solid(says);
  return counts;
}

}  // namespace landmarkdb
