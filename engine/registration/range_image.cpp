#include "engine/registration/range_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "engine/registration/equal_angles.hpp"

namespace landmarkdb {

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// What a direction says of a pose; below zero it contradicts.
constexpr signed char kAgrees = 1, kNothing = 0, kCrossed = -1, kHidden = -2;
constexpr int kWidestPatch = 6;  // cells to each side: what stands at the lens fills no more

}  // namespace

std::vector<std::vector<Eigen::Vector3f>> points_by_viewpoint(
    std::span<const Eigen::Vector3f> points,
    std::size_t viewpoints,
    std::span<const std::uint16_t> viewpoint_index) {
  std::vector<std::vector<Eigen::Vector3f>> seen(viewpoints);
  for (std::size_t i = 0; i < points.size() && viewpoints > 0; ++i) {
    seen[viewpoint_index.empty() ? 0 : viewpoint_index[i]].push_back(points[i]);
  }
  return seen;
}

RangeImage::RangeImage(std::span<const Eigen::Vector3f> points,
                       const Eigen::Vector3f& viewpoint,
                       double finest_step_rad)
    : viewpoint_(viewpoint), step_rad_(finest_step_rad) {
  choose_step(points);
  measure_cone(points);
  number_inner();
}

// The finest step at which most of the measured cells have measured neighbours, or enough have: a
// view in shreds is compared where it is whole. Where there is no such step, that at which most of
// the sphere is covered.
void RangeImage::choose_step(std::span<const Eigen::Vector3f> points) {
  constexpr double kMost = 0.6;          // of the measured cells
  constexpr std::size_t kEnough = 300;   // an eighth of a depth camera's view
  constexpr double kCoarsestRad = 0.14;  // 8 deg
  double best_step_rad = step_rad_;
  double most_covered = -1.0;  // solid angle
  for (;; step_rad_ *= 2.0) {
    measure(points);
    const Completeness found = completeness();
    const auto complete = static_cast<double>(found.complete);
    if (complete >= kMost * static_cast<double>(found.measured)) return;
    if (found.complete >= kEnough) return;
    const double covered = complete * step_rad_ * step_rad_;
    if (covered > most_covered) {
      most_covered = covered;
      best_step_rad = step_rad_;
    }
    if (step_rad_ >= kCoarsestRad) break;
  }
  if (step_rad_ == best_step_rad) return;
  step_rad_ = best_step_rad;
  measure(points);
}

void RangeImage::measure_cone(std::span<const Eigen::Vector3f> points) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& point : points) sum += (point - viewpoint_).normalized();
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
  cone_half_angle_rad_ = static_cast<float>(std::min(half_angle, std::numbers::pi));
  cone_cosine_ = half_angle < std::numbers::pi ? static_cast<float>(std::cos(half_angle)) : -1.0F;
}

void RangeImage::number_inner() {
  inner_of_cell_.assign(cells_.size(), kOuter);
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) {
    if (!(widened_[cell].furthest > 0.0F)) continue;
    inner_of_cell_[cell] = static_cast<std::uint32_t>(inner_.size());
    inner_.push_back(static_cast<std::uint32_t>(cell));
  }
}

void RangeImage::measure(std::span<const Eigen::Vector3f> points) {
  constexpr int kMostCells = 4095;  // SightRay has twelve bits for a row
  const double cells = std::ceil(0.5 * std::numbers::pi / step_rad_);
  side_ = std::clamp(static_cast<int>(cells), 4, kMostCells);
  cells_.assign(6 * static_cast<std::size_t>(side_ * side_), Cell{kInfinity, 0.0F});
  const SightView all_around{.t_view_surface = -viewpoint_, .reach_m = kInfinity, .side = side_};
  const SightKernel look = sight_kernel();
  std::array<SightRay, 256> rays;
  for (std::size_t first = 0; first < points.size(); first += rays.size()) {
    const std::size_t count = std::min(rays.size(), points.size() - first);
    look(points[first].data(), nullptr, count, all_around, rays.data());
    for (const SightRay& ray : std::span(rays).first(count)) {
      if (!(ray.range_m > 0.0F)) continue;
      Cell& cell = cells_[index_of(place_of(ray))];
      cell.nearest = std::min(cell.nearest, ray.range_m);
      cell.furthest = std::max(cell.furthest, ray.range_m);
      max_range_m_ = std::max(max_range_m_, ray.range_m);
    }
  }
  widened_.clear();
  widened_.reserve(cells_.size());
  for (std::size_t cell = 0; cell < cells_.size(); ++cell) widened_.push_back(widen(cell));
}

RangeImage::Completeness RangeImage::completeness() const {
  Completeness found;
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    found.measured += cells_[i].furthest > 0.0F ? 1U : 0U;
    found.complete += widened_[i].furthest > 0.0F ? 1U : 0U;
  }
  return found;
}

int RangeImage::cell_along(float tangent) const {
  const float along = along_face(tangent) * static_cast<float>(side_);
  return std::clamp(static_cast<int>(along), 0, side_ - 1);
}

RangeImage::Place RangeImage::place_of(const Eigen::Vector3f& ray) const {
  int axis = 0;
  const float inverse_depth = 1.0F / ray.cwiseAbs().maxCoeff(&axis);
  return {2 * axis + (ray(axis) < 0.0F ? 1 : 0),
          cell_along(ray((axis + 1) % 3) * inverse_depth),
          cell_along(ray((axis + 2) % 3) * inverse_depth)};
}

RangeImage::Place RangeImage::place_at(std::size_t cell) const {
  const int index = static_cast<int>(cell);
  return {index / (side_ * side_), (index / side_) % side_, index % side_};
}

RangeImage::Place RangeImage::place_of(const SightRay& ray) {
  return {ray.place >> 24, (ray.place >> 12) & 0xfff, ray.place & 0xfff};
}

std::size_t RangeImage::index_of(const Place& place) const {
  return static_cast<std::size_t>((place.face * side_ + place.row) * side_ + place.column);
}

RangeImage::Cell RangeImage::widen(std::size_t cell) const {
  const Place place = place_at(cell);
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
  solid_crossed += other.solid_crossed;
  return *this;
}

OutlineCounts& OutlineCounts::operator+=(const OutlineCounts& other) {
  measured += other.measured;
  continued += other.continued;
  return *this;
}

bool RangeImage::in_view(const Eigen::Vector3f& centre, float radius_m) const {
  const float distance = centre.norm();
  if (distance <= radius_m) return true;
  if (distance - radius_m > 2.0F * max_range_m_) return false;  // as in render
  constexpr float kRounding_rad = 1e-3F;
  const float reach = cone_half_angle_rad_ + std::asin(radius_m / distance) + kRounding_rad;
  return reach >= std::numbers::pi_v<float> || cone_axis_.dot(centre) >= std::cos(reach) * distance;
}

RangeImage::Rendered RangeImage::render(const SightSurface& surface,
                                        const Eigen::Isometry3d& T_here_surface,
                                        float patch_m) const {
  const SightView view{T_here_surface.linear().cast<float>(),
                       T_here_surface.translation().cast<float>() - viewpoint_,
                       cone_axis_,
                       cone_cosine_,
                       2.0F * max_range_m_,  // what lies further could only be hidden
                       side_};
  const float half_patch_cells = 0.5F * patch_m / static_cast<float>(step_rad_);
  // From here on a cell is three patches wide.
  const float far_m = 3.0F * patch_m / static_cast<float>(step_rad_);
  Rendered rendered;
  rendered.predicted.assign(inner_.size(), {kInfinity, false});
  const SightKernel look = sight_kernel();
  std::array<SightRay, SightSurface::kBlockPoints> rays;
  for (const SightSurface::Block& block : surface.blocks()) {
    const Eigen::Vector3f centre = view.R_view_surface * block.centre + view.t_view_surface;
    if (!in_view(centre, block.radius_m)) continue;
    const bool is_far = centre.norm() - block.radius_m > far_m;
    const std::size_t count = (is_far ? block.spread_end : block.end) - block.begin;
    const float* normals = surface.has_normals() ? surface.normals()[block.begin].data() : nullptr;
    look(surface.points()[block.begin].data(), normals, count, view, rays.data());
    for (const SightRay& ray : std::span(rays).first(count)) {
      if (!(ray.range_m > 0.0F)) continue;
      const int half = static_cast<int>(
          std::min(static_cast<float>(kWidestPatch), half_patch_cells / ray.range_m + 0.5F));
      lay_patch(place_of(ray), half, {ray.range_m, ray.back != 0}, rendered.predicted);
    }
  }
  rendered.boxes = boxes_of(rendered.predicted);
  return rendered;
}

std::array<RangeImage::Box, 6> RangeImage::boxes_of(std::span<const Predicted> predicted) const {
  std::array<Box, 6> boxes;
  for (std::size_t i = 0; i < predicted.size(); ++i) {
    if (predicted[i].range == kInfinity) continue;
    const Place place = place_at(inner_[i]);
    Box& box = boxes[static_cast<std::size_t>(place.face)];
    box.first_row = std::min(box.first_row, place.row);
    box.last_row = std::max(box.last_row, place.row);
    box.first_column = std::min(box.first_column, place.column);
    box.last_column = std::max(box.last_column, place.column);
  }
  return boxes;
}

void RangeImage::lay_patch(const Place& place,
                           int half,
                           const Predicted& patch,
                           std::span<Predicted> predicted) const {
  const int first_row = std::max(0, place.row - half);
  const int last_row = std::min(side_ - 1, place.row + half);
  const int first_column = std::max(0, place.column - half);
  const int last_column = std::min(side_ - 1, place.column + half);
  for (int row = first_row; row <= last_row; ++row) {
    const std::size_t begin = index_of({place.face, row, 0});
    for (int column = first_column; column <= last_column; ++column) {
      const std::uint32_t inner = inner_of_cell_[begin + static_cast<std::size_t>(column)];
      if (inner == kOuter) continue;
      Predicted& nearest = predicted[inner];
      if (patch.range < nearest.range) nearest = patch;
    }
  }
}

// Calls `visit` with the number, ascending, and the place of each cell in the boxes that is
// compared.
template <typename Visit>
void RangeImage::visit_inner(const std::array<Box, 6>& boxes, const Visit& visit) const {
  for (int face = 0; face < 6; ++face) {
    const Box& box = boxes[static_cast<std::size_t>(face)];
    for (int row = box.first_row; row <= box.last_row; ++row) {
      for (int column = box.first_column; column <= box.last_column; ++column) {
        const Place place{face, row, column};
        const std::uint32_t inner = inner_of_cell_[index_of(place)];
        if (inner != kOuter) visit(inner, place);
      }
    }
  }
}

// Calls `visit` with the number of each of the up to eight around `place` that are compared.
template <typename Visit>
void RangeImage::visit_around(const Place& place, const Visit& visit) const {
  const int last_row = std::min(side_ - 1, place.row + 1);
  const int last_column = std::min(side_ - 1, place.column + 1);
  for (int row = std::max(0, place.row - 1); row <= last_row; ++row) {
    for (int column = std::max(0, place.column - 1); column <= last_column; ++column) {
      if (row == place.row && column == place.column) continue;
      const std::uint32_t beside = inner_of_cell_[index_of({place.face, row, column})];
      if (beside != kOuter) visit(beside);
    }
  }
}

void RangeImage::fill_gaps(Rendered& rendered) const {
  constexpr int kEnough = 5;  // of the eight around: beyond a straight edge there are three
  std::vector<Predicted>& predicted = rendered.predicted;
  std::vector<std::pair<std::size_t, Predicted>> filled;
  visit_inner(rendered.boxes, [&](std::uint32_t i, const Place& place) {
    if (predicted[i].range != kInfinity) return;
    int around = 0;
    Predicted furthest{0.0F, false};
    visit_around(place, [&](std::uint32_t beside) {
      if (predicted[beside].range == kInfinity) return;
      ++around;
      if (predicted[beside].range > furthest.range) furthest = predicted[beside];
    });
    if (around >= kEnough) filled.emplace_back(i, furthest);
  });
  for (const auto& [i, patch] : filled) predicted[i] = patch;
}

void RangeImage::count_solid(const std::array<Box, 6>& boxes,
                             const std::vector<signed char>& says,
                             SightCounts& counts) const {
  visit_inner(boxes, [&](std::uint32_t i, const Place& place) {
    if (says[i] >= 0) return;
    bool alone = true;
    visit_around(place, [&](std::uint32_t beside) { alone = alone && says[beside] <= 0; });
    counts.solid += alone ? 1U : 0U;
    counts.solid_crossed += alone && says[i] == kCrossed ? 1U : 0U;
  });
}

RangeImage::Measured RangeImage::measured_at(const Eigen::Vector3f& p) const {
  constexpr Cell kUnknown{0.0F, 0.0F};
  const Eigen::Vector3f ray = p - viewpoint_;
  const float range = ray.norm();
  if (!(range > 0.0F) || cone_axis_.dot(ray) < cone_cosine_ * range) return {range, kUnknown};
  return {range, widened_[index_of(place_of(ray))]};
}

bool RangeImage::hides(const Eigen::Vector3f& p, float slack_m) const {
  const auto [range, wide] = measured_at(p);
  return wide.furthest > 0.0F && range > wide.furthest + slack_m;
}

bool RangeImage::looked_through(const Eigen::Vector3f& p, float slack_m) const {
  const auto [range, wide] = measured_at(p);
  return wide.furthest > 0.0F && range < wide.nearest - slack_m;
}

std::size_t RangeImage::memory_bytes() const {
  return (cells_.size() + widened_.size()) * sizeof(Cell) +
         (inner_.size() + inner_of_cell_.size()) * sizeof(std::uint32_t);
}

SightCounts RangeImage::compare(const SightSurface& surface,
                                const Eigen::Isometry3d& T_here_surface,
                                float patch_m,
                                const SightTolerance& tolerance) const {
  Rendered rendered = render(surface, T_here_surface, patch_m);
  fill_gaps(rendered);
  const std::vector<Predicted>& predicted = rendered.predicted;
  SightCounts counts;
  counts.measured = inner_.size();
  std::vector<signed char> says(inner_.size(), kNothing);
  const auto compared = [](const Predicted& patch, const Cell& wide, float slack) -> signed char {
    if (patch.range < wide.nearest - slack) return kCrossed;
    if (patch.back) return kNothing;
    return patch.range <= wide.furthest + slack ? kAgrees : kHidden;
  };
  visit_inner(rendered.boxes, [&](std::uint32_t i, const Place&) {
    if (predicted[i].range == kInfinity) return;
    const Cell& wide = widened_[inner_[i]];
    const float slack = tolerance.metres + tolerance.share * wide.furthest;
    const signed char said = compared(predicted[i], wide, slack);
    counts.crossed += said == kCrossed ? 1U : 0U;
    counts.agree += said == kAgrees ? 1U : 0U;
    counts.hidden += said == kHidden ? 1U : 0U;
    if (said != kNothing) says[i] = compared(predicted[i], wide, tolerance.solid * slack);
  });
  count_solid(rendered.boxes, says, counts);
  return counts;
}

OutlineCounts RangeImage::outline(const SightSurface& surface,
                                  const Eigen::Isometry3d& T_here_surface,
                                  float patch_m,
                                  const SightTolerance& tolerance) const {
  constexpr int kBeyond = 2;  // cells: the next may show the object's own edge
  const Rendered rendered = render(surface, T_here_surface, patch_m);
  const std::vector<Predicted>& predicted = rendered.predicted;
  const auto range_at = [&](const Place& place) {
    if (place.row < 0 || place.row >= side_ || place.column < 0 || place.column >= side_) {
      return -1.0F;
    }
    const std::uint32_t inner = inner_of_cell_[index_of(place)];
    return inner == kOuter ? -1.0F : predicted[inner].range;
  };
  OutlineCounts counts;
  visit_inner(rendered.boxes, [&](std::uint32_t i, const Place& place) {
    const float range = predicted[i].range;
    if (range == kInfinity || predicted[i].back) return;
    const Cell& wide = widened_[inner_[i]];
    const float slack = tolerance.metres + tolerance.share * range;
    if (range < wide.nearest - slack || range > wide.furthest + slack) return;
    for (const auto& [down, right] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Place next{place.face, place.row + down, place.column + right};
      const Place beyond{place.face, place.row + kBeyond * down, place.column + kBeyond * right};
      if (range_at(next) != kInfinity || range_at(beyond) != kInfinity) continue;
      const Cell& there = cells_[index_of(beyond)];
      ++counts.measured;
      if (range >= there.nearest - slack && range <= there.furthest + slack) ++counts.continued;
    }
  });
  return counts;
}

}  // namespace landmarkdb
