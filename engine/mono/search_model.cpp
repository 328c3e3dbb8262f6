#include "engine/mono/search_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/Eigenvalues>

#include "engine/geometry/pose.hpp"
#include "engine/mono/model_faces.hpp"

namespace landmarkdb {
namespace {

// The nearest view by place on a cube around the object, worked out once: views are 11 degrees
// apart, places of the cube half a degree to one, so a direction half way between two views may get
// the one that is a little further.
class ViewTable {
 public:
  ViewTable() : nearest_(6 * kAcross * kAcross) {
    for (std::size_t face = 0; face < 6; ++face) {
      for (std::size_t i = 0; i < kAcross; ++i) {
        for (std::size_t j = 0; j < kAcross; ++j) {
          Eigen::Vector3d direction;
          direction[static_cast<Eigen::Index>(face / 2)] = face % 2 == 0 ? 1.0 : -1.0;
          direction[static_cast<Eigen::Index>((face / 2 + 1) % 3)] = middle(i);
          direction[static_cast<Eigen::Index>((face / 2 + 2) % 3)] = middle(j);
          nearest_[(face * kAcross + i) * kAcross + j] = find(direction);
        }
      }
    }
  }

  std::size_t at(const Eigen::Vector3d& direction) const {
    // Without branches: which axis is the longest is as good as chance.
    const Eigen::Vector3d size = direction.cwiseAbs();
    const double of_two = std::max(size.x(), size.y()), longest = std::max(of_two, size.z());
    Eigen::Index axis = size.y() > size.x() ? 1 : 0;
    axis = size.z() > of_two ? 2 : axis;
    if (!(longest > 0.0) || !std::isfinite(size.sum())) return 0;
    const std::size_t face = 2 * static_cast<std::size_t>(axis) + (direction[axis] > 0.0 ? 0 : 1);
    const std::size_t i = place(direction[(axis + 1) % 3] / longest);
    const std::size_t j = place(direction[(axis + 2) % 3] / longest);
    return nearest_[(face * kAcross + i) * kAcross + j];
  }

 private:
  static constexpr std::size_t kAcross = 96;

  static double middle(std::size_t i) {
    return (2.0 * static_cast<double>(i) + 1.0) / double{kAcross} - 1.0;
  }
  static std::size_t place(double x) {
    const double at = 0.5 * (x + 1.0) * double{kAcross};
    return at <= 0.0 ? 0 : std::min(kAcross - 1, static_cast<std::size_t>(at));
  }
  // Views come in equal steps of z, and each direction has one within 0.2 rad: the others need not
  // be asked.
  static std::uint8_t find(const Eigen::Vector3d& direction) {
    constexpr double kReach = 0.2 * double{kModelViews} / 2.0 + 1.0;
    const std::array<Eigen::Vector3d, kModelViews>& views = model_views();
    const double at = 0.5 * (1.0 - direction.z() / direction.norm()) * double{kModelViews};
    const auto first = static_cast<std::size_t>(std::max(0.0, at - kReach));
    const auto end = std::min(kModelViews, static_cast<std::size_t>(at + kReach));
    std::size_t best = first;
    double nearest = -2.0 * direction.norm();
    for (std::size_t i = first; i < end; ++i) {
      const double cosine = views[i].dot(direction);
      if (cosine <= nearest) continue;
      nearest = cosine;
      best = i;
    }
    return static_cast<std::uint8_t>(best);
  }

  std::vector<std::uint8_t> nearest_;
};

}  // namespace

namespace {

// Makes `point` the centroid of a face.
void spread_over_face(const MonoModel& model,
                      std::span<const std::uint32_t> face,
                      PosePoint& point) {
  // Ascending: across the plane, the shorter axis, the longer. A disc of radius r has r^2 / 4.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(4.0 * area_spread(model, face));
  const Eigen::Vector3d squares = axes.eigenvalues().cwiseMax(0.0);
  if (!(squares[1] > 0.0)) return;
  point.radius_m = std::sqrt(squares[1]);
  point.normal = axes.eigenvectors().col(0);
  point.longer = std::sqrt(squares[2] - squares[1]) * axes.eigenvectors().col(2);
}

}  // namespace

std::vector<PosePoint> pose_points(const MonoModel& model) {
  std::vector<PosePoint> points;
  for (const ModelFeature& feature : model.points) {
    PosePoint point;
    point.xyz = feature.xyz;
    if (feature.type == FeatureType::kConicCentre && feature.part >= 0) {
      const ModelCircle& circle = model.circles[static_cast<std::size_t>(feature.part)];
      point.radius_m = circle.radius_m;
      point.normal = circle.normal.normalized();
    }
    if (feature.type == FeatureType::kCentroid && feature.part >= 0) {
      spread_over_face(model, model.faces[static_cast<std::size_t>(feature.part)], point);
    }
    points.push_back(point);
  }
  return points;
}

SearchTables tables_of(const MonoModelRecord& record, const RunContext& context, QuadUse quads) {
  if (record.index) {
    if (std::optional<SearchTables> tables = read_model_index(*record.index, record.model, quads)) {
      return std::move(*tables);
    }
  }
  return make_search_tables(record.model, context, quads);
}

SearchModel prepare_model(std::shared_ptr<const MonoModelRecord> record) {
  const SearchTables tables = tables_of(*record);
  return prepare_model(std::move(record), tables);
}

SearchModel prepare_model(std::shared_ptr<const MonoModelRecord> record,
                          const SearchTables& tables) {
  const MonoModel& model = record->model;
  SearchModel result{.record = record,
                     .visibility = ModelVisibility(model),
                     .points = pose_points(model),
                     .neighbours = {},
                     .joined = std::vector<char>(model.points.size() * model.points.size(), 0),
                     .seen = {},
                     .center = mean_point(model),
                     .radius_m = 0.0,
                     .quads = tables.quads,
                     .outline_seen = tables.outline_seen,
                     .lookalikes = tables.lookalikes};
  for (const PosePoint& point : result.points) {
    result.radius_m = std::max(result.radius_m, (point.xyz - result.center).norm());
  }
  result.neighbours.resize(model.points.size());
  for (const auto& [a, b] : model.edges) {
    result.neighbours[a].push_back(b);
    result.neighbours[b].push_back(a);
    result.joined[a * model.points.size() + b] = result.joined[b * model.points.size() + a] = 1;
  }
  for (std::vector<std::uint32_t>& list : result.neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  result.seen.resize(kModelViews);
  for (std::size_t view = 0; view < kModelViews; ++view) {
    for (std::size_t i = 0; i < model.points.size(); ++i) {
      if (tables.seen[i][view]) result.seen[view].push_back(static_cast<std::uint16_t>(i));
    }
  }
  return result;
}

std::size_t nearest_view(const Eigen::Vector3d& direction) {
  static const ViewTable table;
  return table.at(direction);
}

bool same_but_for_symmetry(const SearchModel& model,
                           const RigidPose& a,
                           const RigidPose& b,
                           double angle_rad,
                           double distance_m) {
  if ((a * model.center - b * model.center).norm() > distance_m) {
    // A symmetry need not keep the mean of the points where it is (points seen on one side only).
    if (model.model().symmetries.size() < 2) return false;
  }
  const auto near = [&](const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
    const Eigen::Matrix3d turned = b.R * R;
    return (turned * model.center + b.R * t + b.t - a * model.center).norm() <= distance_m &&
           rotation_angle_rad(a.R.transpose() * turned) <= angle_rad;
  };
  if (near(Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero())) return true;
  for (const Eigen::Matrix4d& symmetry : model.model().symmetries) {
    if (near(symmetry.topLeftCorner<3, 3>(), symmetry.topRightCorner<3, 1>())) return true;
  }
  return false;
}

}  // namespace landmarkdb
