#include "engine/mono/edge_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace landmarkdb {
namespace {

constexpr double kCell_px = 4.0;
constexpr double kShareReach_px = 2.0;
constexpr double kShareCosine = 0.9396926;  // 20 degrees
constexpr std::size_t kCircleSamples = 24;  // of a circle's rim
constexpr double kGrazing = 0.05;           // n.view at which a rim on a face is no longer seen

// Adds the sample where a direction along an edge shows up in the image.
bool add_sample(const PlaceSight& sight,
                const Camera& camera,
                const RigidPose& pose,
                const Eigen::Vector3d& place,
                const Eigen::Vector3d& along,
                std::size_t line,
                std::vector<EdgeSample>& samples) {
  const Eigen::Vector3d X = pose * place;
  if (!(X.z() > 0.0)) return false;
  const Eigen::Vector2d ray = X.head<2>() / X.z();
  if (!inside_lens_model(camera, ray)) return false;
  const LensPoint lens = distort_with_slope(camera, ray);
  if (!(lens.uv.x() >= 0.0) || !(lens.uv.y() >= 0.0) || !(lens.uv.x() <= camera.width - 1.0) ||
      !(lens.uv.y() <= camera.height - 1.0)) {
    return false;
  }
  if (!sight.sees(place)) return false;
  const Eigen::Vector3d d = pose.R * along;
  const Eigen::Vector2d tangent = lens.duv_dray * (d.head<2>() - ray * d.z());
  const double length = tangent.norm();
  if (!(length > 0.0)) return false;
  samples.push_back({place,
                     lens.uv,
                     Eigen::Vector2d(-tangent.y(), tangent.x()) / length,
                     static_cast<std::uint32_t>(line)});
  return true;
}

void add_circle(const PlaceSight& sight,
                const ModelCircle& circle,
                const Camera& camera,
                const RigidPose& pose,
                const Eigen::Vector3d& eye,
                std::size_t line,
                std::vector<EdgeSample>& samples) {
  const Eigen::Vector3d n = circle.normal.normalized();
  const Eigen::Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  for (std::size_t i = 0; i < kCircleSamples; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / double{kCircleSamples};
    const Eigen::Vector3d out = std::cos(angle) * u + std::sin(angle) * v;
    const Eigen::Vector3d along = std::cos(angle) * v - std::sin(angle) * u;
    // A rim lies on a face: it is looked at from a little above it.
    const Eigen::Vector3d place = circle.center + circle.radius_m * out;
    if (std::abs(n.dot((eye - place).normalized())) < kGrazing) continue;
    add_sample(sight, camera, pose, place, along, line, samples);
  }
}

}  // namespace

EdgeGrid::EdgeGrid(const ImageFeatures& features) {
  if (features.edges.empty() || features.width == 0 || features.height == 0) return;
  columns_ = static_cast<std::size_t>(features.width / kCell_px) + 1;
  rows_ = static_cast<std::size_t>(features.height / kCell_px) + 1;
  starts_.assign(columns_ * rows_ + 1, 0);
  const auto cell = [&](const EdgePoint& edge) -> std::optional<std::size_t> {
    const double x = edge.uv.x() / kCell_px, y = edge.uv.y() / kCell_px;
    if (!(x >= 0.0) || !(y >= 0.0) || !(x < static_cast<double>(columns_)) ||
        !(y < static_cast<double>(rows_))) {
      return std::nullopt;
    }
    return static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x);
  };
  for (const EdgePoint& edge : features.edges) {
    if (const auto at = cell(edge)) ++starts_[*at + 1];
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
  edges_.resize(starts_.back());
  std::vector<std::uint32_t> next = starts_;
  for (const EdgePoint& edge : features.edges) {
    if (const auto at = cell(edge)) edges_[next[*at]++] = edge;
  }
  density_ = static_cast<double>(edges_.size()) / (double{1} * features.width * features.height);
}

std::optional<EdgeGrid::Cells> EdgeGrid::cells_near(const Eigen::Vector2d& uv,
                                                    const Eigen::Vector2d& normal,
                                                    double reach_px) const {
  if (edges_.empty()) return std::nullopt;
  constexpr double kRounding_px = 1e-6;
  const double nx = std::abs(normal.x()), ny = std::abs(normal.y());
  const double wide_px = std::min(reach_px, nx * reach_px + ny * kBeside_px + kRounding_px);
  const double high_px = std::min(reach_px, ny * reach_px + nx * kBeside_px + kRounding_px);
  const double x0 = (uv.x() - wide_px) / kCell_px, x1 = (uv.x() + wide_px) / kCell_px;
  const double y0 = (uv.y() - high_px) / kCell_px, y1 = (uv.y() + high_px) / kCell_px;
  if (!(x1 >= 0.0) || !(y1 >= 0.0) || !(x0 < static_cast<double>(columns_)) ||
      !(y0 < static_cast<double>(rows_))) {
    return std::nullopt;
  }
  const auto low = [](double c) { return static_cast<std::size_t>(std::max(0.0, c)); };
  return Cells{low(x0), std::min(columns_ - 1, low(x1)), low(y0), std::min(rows_ - 1, low(y1))};
}

const EdgePoint* EdgeGrid::nearest(const Eigen::Vector2d& uv,
                                   const Eigen::Vector2d& normal,
                                   double reach_px,
                                   double min_cosine) const {
  const std::optional<Cells> cells = cells_near(uv, normal, reach_px);
  if (!cells) return nullptr;
  const EdgePoint* best = nullptr;
  double least = reach_px;
  for (std::size_t y = cells->first_y; y <= cells->last_y; ++y) {
    for (const EdgePoint& edge : row_of(*cells, y)) {
      const Eigen::Vector2d d = edge.uv.cast<double>() - uv;
      const double along = std::abs(d.dot(normal));
      if (!(along < least) || std::abs(d.x() * normal.y() - d.y() * normal.x()) > kBeside_px)
        continue;
      if (std::abs(edge.normal.cast<double>().dot(normal)) < min_cosine) continue;
      least = along;
      best = &edge;
    }
  }
  return best;
}

std::vector<EdgeSample> visible_edges(const SearchModel& model,
                                      const Camera& camera,
                                      const RigidPose& pose,
                                      double step_px,
                                      std::size_t most) {
  std::vector<EdgeSample> samples;
  const Eigen::Vector3d eye = -(pose.R.transpose() * pose.t);
  const PlaceSight sight(model.visibility, eye);
  const MonoModel& m = model.model();
  const double focal = 0.5 * (std::abs(camera.fx) + std::abs(camera.fy));
  const std::size_t lines = m.edges.size() + m.circles.size();
  if (lines == 0) return samples;
  const std::size_t share = std::max<std::size_t>(2, most / lines);
  for (std::size_t line = 0; line < m.edges.size(); ++line) {
    const auto& [a, b] = m.edges[line];
    const Eigen::Vector3d& from = m.points[a].xyz;
    const Eigen::Vector3d along = m.points[b].xyz - from;
    const double depth = (pose * (from + 0.5 * along)).z();
    if (!(depth > 0.0)) continue;
    const double steps = std::ceil(focal * along.norm() / (depth * step_px));
    const std::size_t n =
        static_cast<std::size_t>(std::clamp(steps, 2.0, static_cast<double>(share)));
    for (std::size_t i = 0; i < n; ++i) {
      const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(n);
      add_sample(sight, camera, pose, from + at * along, along, line, samples);
    }
  }
  for (const ModelCircle& circle : m.circles)
    add_circle(sight, circle, camera, pose, eye, m.edges.size(), samples);
  return samples;
}

double edge_share(std::span<const EdgeSample> samples, const EdgeGrid& grid) {
  if (samples.empty()) return 0.0;
  std::size_t on_edge = 0;
  for (const EdgeSample& sample : samples) {
    if (grid.nearest(sample.uv, sample.normal, kShareReach_px, kShareCosine) != nullptr) ++on_edge;
  }
  return static_cast<double>(on_edge) / static_cast<double>(samples.size());
}

}  // namespace landmarkdb
