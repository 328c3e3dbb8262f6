#include "engine/mono/edge_outline.hpp"

#include <algorithm>
#include <cmath>

namespace landmarkdb {
namespace {

constexpr double kCell_px = 2.0;
constexpr unsigned kDirections = 8;  // of 22.5 degrees, over half a turn

// The number of the direction class of a line, whichever way it points.
unsigned class_of(double x, double y) {
  constexpr double kSteps[3] = {0.41421356237309503, 1.0, 2.414213562373095};  // tan 22.5, 45, 67.5
  if (y < 0.0 || (y == 0.0 && x < 0.0)) {
    x = -x;
    y = -y;
  }
  const bool obtuse = x < 0.0;
  const double across = std::abs(x);
  unsigned step = 0;
  while (step < 3 && y >= kSteps[step] * across) ++step;
  return obtuse ? kDirections - 1 - step : step;
}

}  // namespace

EdgeDirections::EdgeDirections(const ImageFeatures& features) {
  if (features.edges.empty()) return;
  columns_ = static_cast<std::size_t>(features.width / kCell_px) + 1;
  rows_ = static_cast<std::size_t>(features.height / kCell_px) + 1;
  bits_.assign(columns_ * rows_, 0);
  for (const EdgePoint& edge : features.edges) {
    const double u = edge.uv.x() / kCell_px;
    const double v = edge.uv.y() / kCell_px;
    if (!(u >= 0.0) || !(v >= 0.0)) continue;
    const auto x = static_cast<std::size_t>(u), y = static_cast<std::size_t>(v);
    if (x >= columns_ || y >= rows_) continue;
    const unsigned own = class_of(-double{edge.normal.y()}, double{edge.normal.x()});
    // Its own class and those beside it.
    const unsigned bits = (1U << own) | (1U << ((own + 1) % kDirections)) |
                          (1U << ((own + kDirections - 1) % kDirections));
    for (std::size_t row = y == 0 ? 0 : y - 1; row <= std::min(rows_ - 1, y + 1); ++row) {
      for (std::size_t column = x == 0 ? 0 : x - 1; column <= std::min(columns_ - 1, x + 1);
           ++column) {
        std::uint8_t& cell = bits_[row * columns_ + column];
        cell = static_cast<std::uint8_t>(cell | bits);
      }
    }
  }
}

bool EdgeDirections::inside(const Eigen::Vector2d& uv) const {
  return uv.x() >= 0.0 && uv.y() >= 0.0 && uv.x() < kCell_px * static_cast<double>(columns_) &&
         uv.y() < kCell_px * static_cast<double>(rows_);
}

bool EdgeDirections::runs(const Eigen::Vector2d& uv, const Eigen::Vector2d& tangent) const {
  const auto x = static_cast<std::size_t>(uv.x() / kCell_px);
  const auto y = static_cast<std::size_t>(uv.y() / kCell_px);
  return ((bits_[y * columns_ + x] >> class_of(tangent.x(), tangent.y())) & 1U) != 0;
}

EdgeOutline::EdgeOutline(const SearchModel& search)
    : places_(outline_places(search.model())), center_(search.center) {
  if (places_.empty()) return;
  for (std::size_t view = 0; view < kModelViews; ++view) {
    std::vector<std::uint16_t> ids;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (search.outline_seen[i][view]) ids.push_back(static_cast<std::uint16_t>(i));
    }
    // A stride that shares no factor with most counts: the first dozen speak for all edges.
    std::vector<std::uint16_t> mixed;
    constexpr std::size_t kStride = 7;
    for (std::size_t first = 0; first < kStride; ++first) {
      for (std::size_t i = first; i < ids.size(); i += kStride) mixed.push_back(ids[i]);
    }
    seen_.push_back(std::move(mixed));
  }
}

double EdgeOutline::share(const RigidPose& pose,
                          const Camera& camera,
                          const EdgeDirections& edges,
                          double enough) const {
  if (seen_.empty()) return 0.0;
  const Eigen::Vector3d sight = -(pose.R.transpose() * pose.t) - center_;
  const std::vector<std::uint16_t>& seen = seen_[nearest_view(sight.normalized())];
  const double most_missed = (1.0 - enough) * static_cast<double>(seen.size());
  std::size_t hits = 0, missed = 0;
  for (const std::uint16_t id : seen) {
    const Eigen::Vector3d X = pose * places_[id].xyz;
    if (!(X.z() > 0.0)) return 0.0;
    const Eigen::Vector2d ray = X.head<2>() / X.z();
    const Eigen::Vector2d uv = distort(camera, ray);
    if (!uv.allFinite() || !edges.inside(uv)) continue;
    const Eigen::Vector3d d = pose.R * places_[id].along;
    Eigen::Vector2d tangent = d.head<2>() - ray * d.z();
    tangent = {camera.fx * tangent.x(), camera.fy * tangent.y()};
    if (edges.runs(uv, tangent)) {
      ++hits;
    } else if (static_cast<double>(++missed) > most_missed) {
      return 0.0;
    }
  }
  const std::size_t asked = hits + missed;
  if (3 * asked < seen.size() || asked == 0) return 0.0;
  return static_cast<double>(hits) / static_cast<double>(asked);
}

}  // namespace landmarkdb
