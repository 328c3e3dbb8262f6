#include "client/report/picture.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <Eigen/Geometry>

namespace landmarkdb::client {
namespace {

constexpr double kWide_px = 800.0;
constexpr double kHigh_px = 600.0;
constexpr double kFilled = 0.9;    // of the picture
constexpr double kLeast_m = 1e-3;  // what is shown of a single point
constexpr std::size_t kMostPlacePoints = 6'000;
constexpr std::size_t kMostQueryPoints = 3'000;

using Points = std::vector<Eigen::Vector3d>;

// About `most` of the points, evenly chosen, that `passes`.
template <typename Position, typename Passes>
Points some(std::size_t count, std::size_t most, const Position& position, const Passes& passes) {
  const std::size_t step = std::max<std::size_t>(1, (count + most - 1) / most);
  Points points;
  for (std::size_t i = 0; i < count; i += step) {
    const Eigen::Vector3d point = position(i);
    if (passes(point)) points.push_back(point);
  }
  return points;
}

// Scene to pixels, orthographic.
class Projection {
 public:
  Projection(const Eigen::Vector3d& right, const Eigen::Vector3d& upward)
      : right_(right), upward_(upward) {}

  void take(const Points& points) {
    for (const Eigen::Vector3d& point : points) box_.extend(flat(point));
  }
  Eigen::Vector2d pixel(const Eigen::Vector3d& point) const {
    const Eigen::Vector2d size = box_.sizes().cwiseMax(kLeast_m);
    const double scale = kFilled * std::min(kWide_px / size.x(), kHigh_px / size.y());
    const Eigen::Vector2d p = scale * (flat(point) - box_.center());
    return {0.5 * kWide_px + p.x(), 0.5 * kHigh_px - p.y()};
  }

 private:
  Eigen::Vector2d flat(const Eigen::Vector3d& point) const {
    return {point.dot(right_), point.dot(upward_)};
  }
  Eigen::Vector3d right_;
  Eigen::Vector3d upward_;
  Eigen::AlignedBox2d box_;
};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

// Every point a dot of a path: a line of no length with round ends.
std::string dots(const Points& points, const Projection& projection, const char* style) {
  std::string path;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector2d p = projection.pixel(point);
    path += "M" + number(p.x()) + " " + number(p.y()) + "h0";
  }
  return "<path d=\"" + path + "\" style=\"fill:none;stroke-linecap:round;stroke-width:3;" + style +
         "\"/>";
}

std::string polyline(const Points& points, const Projection& projection) {
  std::string list;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector2d p = projection.pixel(point);
    list += number(p.x()) + "," + number(p.y()) + " ";
  }
  return "<polyline points=\"" + list +
         "\" style=\"fill:none;stroke:var(--frustum);stroke-width:2\"/>";
}

}  // namespace

std::string static_picture(const Drawing& drawing, Aspect aspect) {
  const DrawnCandidate* best = drawing.candidates.empty() ? nullptr : &drawing.candidates[0];
  const Eigen::Vector3d up = best ? best->up : drawing.up;
  const Eigen::Vector3d right = aspect == Aspect::kAbove
                                    ? (best ? best->above_right : drawing.above_right)
                                    : (best ? best->side_right : drawing.side_right);
  const Eigen::Vector3d upward = aspect == Aspect::kAbove ? Eigen::Vector3d(up.cross(right)) : up;
  const Eigen::Matrix4d T =
      best ? best->T_scene_sensor : Eigen::Matrix4d(Eigen::Matrix4d::Identity());
  const auto placed = [&](const Eigen::Vector3d& p) -> Eigen::Vector3d {
    return (T * p.homogeneous()).head<3>();
  };
  const double cut_m = aspect == Aspect::kAbove && best && best->cut_m
                           ? *best->cut_m
                           : std::numeric_limits<double>::infinity();
  const auto below = [&](const Eigen::Vector3d& p) { return p.dot(up) <= cut_m; };

  Points place;
  if (best) {
    const SceneView& view = *best->place;
    place = some(
        view.points.size(),
        kMostPlacePoints,
        [&](std::size_t i) { return Eigen::Vector3d(view.origin + view.points[i].cast<double>()); },
        below);
  }
  const Points query = some(
      drawing.query.size(),
      kMostQueryPoints,
      [&](std::size_t i) { return placed(drawing.origin + drawing.query[i].cast<double>()); },
      below);

  Projection projection(right, upward);
  projection.take(place);
  projection.take(query);
  projection.take({placed(drawing.viewpoint)});
  std::string svg = "<svg viewBox=\"0 0 " + number(kWide_px) + " " + number(kHigh_px) +
                    "\" aria-hidden=\"true\">";
  svg += dots(place, projection, "stroke:var(--place-high);opacity:.6");
  svg += dots(query, projection, "stroke:var(--query)");
  for (const std::vector<Eigen::Vector3d>& line : drawing.frustum) {
    Points lifted;
    for (const Eigen::Vector3d& point : line) lifted.push_back(placed(point));
    svg += polyline(lifted, projection);
  }
  return svg + "</svg>";
}

}  // namespace landmarkdb::client
