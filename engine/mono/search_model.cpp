#include "engine/mono/search_model.hpp"

#include <algorithm>
#include <cmath>

#include "engine/geometry/pose.hpp"

namespace landmarkdb {
namespace {

constexpr double kLookalikeShare = 0.4;  // of the points: fewer make no rival

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
    Eigen::Index axis = 0;
    const double longest = direction.cwiseAbs().maxCoeff(&axis);
    if (!(longest > 0.0) || !std::isfinite(longest)) return 0;
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
  static std::uint8_t find(const Eigen::Vector3d& direction) {
    const std::array<Eigen::Vector3d, kModelViews>& views = model_views();
    std::size_t best = 0;
    for (std::size_t i = 1; i < kModelViews; ++i) {
      if (views[i].dot(direction) > views[best].dot(direction)) best = i;
    }
    return static_cast<std::uint8_t>(best);
  }

  std::vector<std::uint8_t> nearest_;
};

}  // namespace

bool SearchModel::linked(std::uint32_t a, std::uint32_t b) const {
  return std::binary_search(neighbours[a].begin(), neighbours[a].end(), b);
}

SearchModel prepare_model(std::shared_ptr<const MonoModelRecord> record,
                          std::size_t most_lookalikes) {
  const MonoModel& model = record->model;
  SearchModel result{.record = record,
                     .visibility = ModelVisibility(model),
                     .points = {},
                     .neighbours = {},
                     .seen = {},
                     .center = Eigen::Vector3d::Zero(),
                     .radius_m = 0.0,
                     .lookalikes = {}};
  for (const ModelFeature& feature : model.points) {
    PosePoint point;
    point.xyz = feature.xyz;
    if (feature.type == FeatureType::kConicCentre && feature.part >= 0) {
      const ModelCircle& circle = model.circles[static_cast<std::size_t>(feature.part)];
      point.radius_m = circle.radius_m;
      point.normal = circle.normal.normalized();
    }
    result.points.push_back(point);
    result.center += feature.xyz;
  }
  result.center /= std::max<double>(1.0, static_cast<double>(model.points.size()));
  for (const PosePoint& point : result.points) {
    result.radius_m = std::max(result.radius_m, (point.xyz - result.center).norm());
  }
  result.neighbours.resize(model.points.size());
  for (const auto& [a, b] : model.edges) {
    result.neighbours[a].push_back(b);
    result.neighbours[b].push_back(a);
  }
  for (std::vector<std::uint32_t>& list : result.neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  for (const Eigen::Vector3d& direction : model_views()) {
    const std::vector<bool> seen = result.visibility.points_along(direction);
    std::vector<std::uint16_t> ids;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (seen[i]) ids.push_back(static_cast<std::uint16_t>(i));
    }
    result.seen.push_back(std::move(ids));
  }
  if (most_lookalikes > 0) {
    result.lookalikes = find_lookalikes(model, kLookalikeShare, most_lookalikes);
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
