#include "engine/mono/outline_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "engine/mono/choose_quads.hpp"
#include "engine/mono/visibility.hpp"

namespace landmarkdb {
namespace {

constexpr std::size_t kMostPlaces = 96;  // of a model: some forty are seen at once
constexpr double kFarViews = 6.0;        // radii away the views are taken from

}  // namespace

std::vector<OutlinePlace> outline_places(const MonoModel& model) {
  std::vector<OutlinePlace> places;
  double length_m = 0.0;
  const auto edge_length = [&](const std::array<std::uint32_t, 2>& edge) {
    return (model.points[edge[1]].xyz - model.points[edge[0]].xyz).norm();
  };
  for (const auto& edge : model.edges) length_m += edge_length(edge);
  const double step_m = length_m / static_cast<double>(kMostPlaces);
  if (!(step_m > 0.0)) return places;
  for (const auto& edge : model.edges) {
    const Eigen::Vector3d from = model.points[edge[0]].xyz;
    const Eigen::Vector3d along = model.points[edge[1]].xyz - from;
    const double length = edge_length(edge);
    const auto count = static_cast<std::size_t>(std::max(1.0, std::round(length / step_m)));
    for (std::size_t i = 0; i < count; ++i) {
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
      places.push_back({from + at * along, along / length});
    }
  }
  return places;
}

std::vector<ViewMask> views_of_outline(const MonoModel& model, const RunContext& context) {
  const std::vector<OutlinePlace> places = outline_places(model);
  std::vector<ViewMask> masks(places.size());
  if (places.empty()) return masks;
  const ModelVisibility visibility(model);
  const Eigen::Vector3d center = mean_point(model);
  double radius_m = 0.0;
  for (const ModelFeature& point : model.points) {
    radius_m = std::max(radius_m, (point.xyz - center).norm());
  }
  for (std::size_t view = 0; view < kModelViews; ++view) {
    context.check("index");
    const Eigen::Vector3d eye = center + kFarViews * radius_m * model_views()[view];
    for (std::size_t i = 0; i < places.size(); ++i) {
      masks[i].set(view, visibility.place_seen_from(places[i].xyz, eye));
    }
  }
  return masks;
}

}  // namespace landmarkdb
