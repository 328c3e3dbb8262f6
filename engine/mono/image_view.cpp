#include "engine/mono/image_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include <Eigen/LU>

#include "engine/base/error.hpp"

namespace landmarkdb {
namespace {

constexpr double kCell_px = 2.0;            // half resolution: a look-up is off by a pixel at most
constexpr std::size_t kMostColumns = 512;   // of the table; a wider image gets wider cells
constexpr std::size_t kMostPoints = 60000;  // fits the table's 16 bits

void refuse(std::size_t point, const std::string& what) {
  throw Error(ErrorCode::kInvalidArgument, "feature point " + std::to_string(point) + ": " + what);
}

}  // namespace

ImageView::ImageView(const ImageFeatures& features, const Camera& camera, double reach_px)
    : focal_px_(0.5 * (std::abs(camera.fx) + std::abs(camera.fy))) {
  if (features.points.size() > kMostPoints) {
    throw Error(ErrorCode::kInvalidArgument,
                "the image has " + std::to_string(features.points.size()) +
                    " feature points, want at most " + std::to_string(kMostPoints));
  }
  std::vector<std::int32_t> here(features.points.size(), -1);
  for (std::size_t i = 0; i < features.points.size(); ++i) {
    const ImageFeature& feature = features.points[i];
    if (!feature.uv.allFinite()) refuse(i, "uv is not finite");
    if (!(feature.sigma_px > 0.0) || !std::isfinite(feature.sigma_px))
      refuse(i, "sigma_px is not positive");
    if (static_cast<std::size_t>(feature.type) >= kFeatureTypes) refuse(i, "unknown type");
    const std::optional<Eigen::Vector2d> ray = undistort(camera, feature.uv);
    if (!ray) {
      ++left_out_;
      continue;
    }
    here[i] = static_cast<std::int32_t>(points_.size());
    Point point{.xy = *ray * focal_px_,
                .uv = feature.uv,
                .source = static_cast<std::uint32_t>(i),
                .type = static_cast<std::uint8_t>(feature.type),
                .sigma_px = feature.sigma_px};
    const Eigen::Matrix2d slope = distort_with_slope(camera, *ray).duv_dray;
    const double det = slope.determinant();
    for (const double direction : feature.directions) {
      if (!std::isfinite(direction)) refuse(i, "a direction is not finite");
      // d ray = slope^-1 d uv
      const double du = std::cos(direction), dv = std::sin(direction);
      const double x = (slope(1, 1) * du - slope(0, 1) * dv) / det;
      const double y = (slope(0, 0) * dv - slope(1, 0) * du) / det;
      point.directions.push_back(std::atan2(y, x));
    }
    points_.push_back(std::move(point));
  }
  for (const auto& [a, b] : features.links) {
    if (a >= here.size() || b >= here.size()) {
      throw Error(ErrorCode::kInvalidArgument,
                  "a link joins points " + std::to_string(a) + " and " + std::to_string(b) +
                      ", want indices below " + std::to_string(here.size()));
    }
    if (a == b || here[a] < 0 || here[b] < 0) continue;
    points_[static_cast<std::size_t>(here[a])].links.push_back(static_cast<std::uint16_t>(here[b]));
    points_[static_cast<std::size_t>(here[b])].links.push_back(static_cast<std::uint16_t>(here[a]));
  }
  for (Point& point : points_) {
    std::sort(point.links.begin(), point.links.end());
    point.links.erase(std::unique(point.links.begin(), point.links.end()), point.links.end());
    links_ += point.links.size();
  }
  links_ /= 2;
  fill_tables(reach_px);
}

bool ImageView::linked(std::size_t a, std::size_t b) const {
  const std::vector<std::uint16_t>& links = points_[a].links;
  return std::binary_search(links.begin(), links.end(), static_cast<std::uint16_t>(b));
}

void ImageView::fill_tables(double reach_px) {
  if (points_.empty()) return;
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
  low_ = -high;
  for (const Point& point : points_) {
    low_ = low_.cwiseMin(point.xy);
    high = high.cwiseMax(point.xy);
  }
  low_.array() -= reach_px;
  high.array() += reach_px;
  const double cell_px = std::max(kCell_px, (high - low_).maxCoeff() / double{kMostColumns});
  per_cell_ = 1.0 / cell_px;
  columns_ = static_cast<std::size_t>((high.x() - low_.x()) * per_cell_) + 1;
  const std::size_t rows = static_cast<std::size_t>((high.y() - low_.y()) * per_cell_) + 1;
  width_ = static_cast<double>(columns_);
  height_ = static_cast<double>(rows);
  std::array<std::vector<float>, kFeatureTypes> nearest;
  const double reach = reach_px * per_cell_;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    std::vector<std::uint16_t>& table = tables_[point.type];
    std::vector<float>& distance = nearest[point.type];
    if (table.empty()) {
      table.assign(columns_ * rows, 0);
      distance.assign(columns_ * rows, std::numeric_limits<float>::infinity());
    }
    const Eigen::Vector2d at = (point.xy - low_) * per_cell_;
    const auto first = [&](double c) { return static_cast<std::size_t>(std::max(0.0, c - reach)); };
    const auto last = [&](double c, std::size_t n) {
      return std::min(n - 1, static_cast<std::size_t>(std::max(0.0, c + reach)));
    };
    for (std::size_t row = first(at.y()); row <= last(at.y(), rows); ++row) {
      const double dy = static_cast<double>(row) + 0.5 - at.y();
      for (std::size_t column = first(at.x()); column <= last(at.x(), columns_); ++column) {
        const double dx = static_cast<double>(column) + 0.5 - at.x();
        const float d2 = static_cast<float>(dx * dx + dy * dy);
        const std::size_t cell = row * columns_ + column;
        if (d2 > (reach + 1.0) * (reach + 1.0) || !(d2 < distance[cell])) continue;
        distance[cell] = d2;
        table[cell] = static_cast<std::uint16_t>(i + 1);
      }
    }
  }
  for (std::vector<std::uint16_t>& table : tables_) {
    if (table.empty()) table.assign(columns_ * rows, 0);
  }
}

}  // namespace landmarkdb
